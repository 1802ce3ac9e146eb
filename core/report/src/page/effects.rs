//! The effects: value, probability, what it means, what can be done, what it may be instead.

use plumbline_effects::Kind;
use plumbline_gap::finding::NamedEffect;
use plumbline_gap::{Finding, Verdict};

use super::figures::unit;
use super::{Area, Detail, GAP, GUTTER, HEADING, count, heading, rule};
use crate::drawing::{Anchor, Drawing, Style, ink};
use crate::font;
use crate::values::{percent, significant, with_interval};

/// Effects that are printed, the largest; the others are counted.
const MOST_EFFECTS: usize = 3;
/// Parameters of one effect that are printed.
const MOST_PARAMETERS: usize = 3;
/// Between two effects.
const BETWEEN: f64 = 7.0;
const PAD: f64 = 9.0;

/// Height of the whole part, the space after it included.
pub fn height(finding: &Finding, width: f64, detail: Detail) -> f64 {
    if finding.effects.is_empty() {
        return 0.0;
    }
    let entries: f64 = finding
        .effects
        .iter()
        .take(MOST_EFFECTS)
        .map(|effect| Entry::of(effect, finding, width, detail).height() + BETWEEN)
        .sum();
    HEADING
        + 2.0
        + entries
        + if finding.effects.len() > MOST_EFFECTS { Style::SMALL.leading() } else { 0.0 }
        + GAP
        - 4.0
}

/// Draws the part; returns where the next one may start.
pub fn draw(drawing: &mut Drawing, area: Area, finding: &Finding, detail: Detail) -> f64 {
    if finding.effects.is_empty() {
        return area.y;
    }
    let title = match finding.verdict {
        Verdict::NotInLibrary if finding.partial => "No names, but these close a part of the gap",
        Verdict::NotInLibrary => "It looks partly like these, but they do not explain it",
        _ => "What is missing in the model",
    };
    heading(drawing, area, title);
    let mut y = area.y + HEADING + 2.0;
    for effect in finding.effects.iter().take(MOST_EFFECTS) {
        let entry = Entry::of(effect, finding, area.width, detail);
        entry.draw(drawing, area.x, y, area.width);
        y += entry.height() + BETWEEN;
    }
    if finding.effects.len() > MOST_EFFECTS {
        let rest = count(finding.effects.len() - MOST_EFFECTS, "smaller one", "smaller ones");
        let text = format!("and {rest}");
        drawing.text([area.x, y + 5.0], text, Style::SMALL);
        y += Style::SMALL.leading();
    }
    y + GAP - 4.0
}

/// One effect, its texts wrapped.
struct Entry {
    name: Vec<String>,
    values: Vec<String>,
    meaning: Vec<String>,
    remedy: Vec<String>,
    others: Vec<(String, bool)>,
    probability: f64,
    class_probability: Option<f64>,
}

impl Entry {
    fn of(effect: &NamedEffect, finding: &Finding, width: f64, detail: Detail) -> Self {
        let [name_width, words_width, _] = columns(width);
        let wrap = |text: &str, width: f64, style: Style, most: usize| {
            font::wrap(text, width, style.size, style.weight, most)
        };
        let kind = Kind::of_id(&effect.id);
        let meaning = kind.map_or("An effect that this version has no words for.", Kind::meaning);
        let meaning = effect
            .not_addable
            .as_ref()
            .map_or(meaning.to_owned(), |why| format!("{meaning} Not added: {why}."));
        let remedy = match (finding.verdict, kind.map(Kind::remedy)) {
            (Verdict::NotInLibrary, _) | (_, None) => String::new(),
            (_, Some(remedy)) => format!("In the lab: {remedy}"),
        };
        let mut others = vec![];
        let alternatives: Vec<String> =
            effect.class.iter().skip(1).map(|member| member.title.clone()).collect();
        if !alternatives.is_empty() {
            let names = alternatives.join("; or ");
            others.extend(
                wrap(&format!("or as well: {names}"), width - PAD, Style::BODY, detail.others)
                    .into_iter()
                    .map(|line| (line, true)),
            );
            if let Some(split) = &effect.split_by {
                let split =
                    wrap(&format!("To tell them apart: {split}."), width - PAD, Style::BODY, detail.others);
                others.extend(split.into_iter().map(|line| (line, false)));
            }
        }
        Self {
            name: wrap(&effect.title, name_width, NAME, detail.name),
            values: wrap(&values(effect, unit(finding)), name_width, Style::BODY, detail.name),
            meaning: wrap(&meaning, words_width, Style::BODY, detail.meaning),
            remedy: if detail.remedy == 0 {
                vec![]
            } else {
                wrap(&remedy, words_width, Style::BODY, detail.remedy)
            },
            others,
            probability: effect.probability,
            class_probability: (effect.class.len() > 1).then_some(effect.class_probability),
        }
    }

    fn lines(&self) -> usize {
        let left = self.name.len() + self.values.len();
        let right = if self.class_probability.is_some() { 3 } else { 2 };
        left.max(self.meaning.len() + self.remedy.len()).max(right)
    }

    fn height(&self) -> f64 {
        Style::BODY.leading() * (self.lines() + self.others.len()) as f64 + 5.0
    }

    fn draw(&self, drawing: &mut Drawing, x: f64, y: f64, width: f64) {
        rule(drawing, x, y, width);
        let leading = Style::BODY.leading();
        let [name_width, words_width, last_width] = columns(width);
        let first = y + 12.0;
        drawing.rect(
            x,
            y + 4.5,
            2.5,
            self.height() - 5.0,
            if self.others.is_empty() { ink::AFTER } else { ink::WARNING },
        );
        let x_name = x + PAD;
        let column = |drawing: &mut Drawing, x: f64, lines: &mut dyn Iterator<Item = (&String, Style)>| {
            for (i, (line, style)) in lines.enumerate() {
                drawing.text([x, first + leading * i as f64], line, style);
            }
        };
        let name = self.name.iter().map(|line| (line, NAME));
        let values = self.values.iter().map(|line| (line, Style::BODY.color(ink::STRONG)));
        column(drawing, x_name, &mut name.chain(values));
        let meaning = self.meaning.iter().map(|line| (line, Style::BODY));
        let remedy = self.remedy.iter().map(|line| (line, Style::BODY.color(ink::WEAK)));
        let x_words = x_name + name_width + GUTTER;
        column(drawing, x_words, &mut meaning.chain(remedy));
        self.probabilities(drawing, x_words + words_width + GUTTER, first, last_width);
        for (i, (line, is_name)) in self.others.iter().enumerate() {
            let color = if *is_name { ink::WARNING } else { ink::TEXT };
            let base = first + leading * (self.lines() + i) as f64;
            drawing.text([x_name, base], line, Style::BODY.color(color));
        }
    }

    fn probabilities(&self, drawing: &mut Drawing, x: f64, first: f64, width: f64) {
        let leading = Style::BODY.leading();
        let share = |value: f64| if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
        drawing.text([x, first], "probability", Style::BODY.color(ink::WEAK));
        drawing.anchored([x + width, first], percent(self.probability), NAME, Anchor::End);
        drawing.rect(x, first + 5.0, width, 4.0, ink::GRID);
        if let Some(class) = self.class_probability {
            drawing.rect(x, first + 5.0, width * share(class), 4.0, ink::FLOOR);
            let text = format!("one of the names: {}", percent(class));
            let text = font::fit(&text, width, Style::SMALL.size, Style::SMALL.weight);
            drawing.text([x, first + leading * 2.0 - 2.0], text, Style::SMALL);
        }
        drawing.rect(x, first + 5.0, width * share(self.probability), 4.0, ink::AFTER);
    }
}

const NAME: Style = Style { size: 8.4, weight: font::Weight::SemiBold, color: ink::STRONG };

/// Widths of name and value, words, probability.
fn columns(width: f64) -> [f64; 3] {
    let free = width - PAD - 2.0 * GUTTER;
    [0.38 * free, 0.43 * free, 0.19 * free]
}

/// Parameters whose intervals exclude zero, the others counted, and what the effect does to the rows in the unit of
/// held-out errors: `(name, scale)`.
fn values(effect: &NamedEffect, (unit, scale): (&str, f64)) -> String {
    let (told, zero): (Vec<_>, Vec<_>) = effect.parameters.iter().partition(|found| found.is_told());
    let named = effect.parameters.len() > 1;
    let mut parts: Vec<String> =
        told.iter().take(MOST_PARAMETERS).map(|found| with_interval(found, named)).collect();
    if told.len() > MOST_PARAMETERS {
        parts.push("…".to_owned());
    }
    parts.extend(match (told.is_empty(), zero.len()) {
        (_, 0) => None,
        (true, _) => Some("size not told from zero".to_owned()),
        (false, more) => Some(format!("{} not told from zero", count(more, "other", "others"))),
    });
    let moved = format!("{} {unit} in these rows", significant(scale * effect.size_m, 2));
    if effect.size_m.is_finite() {
        parts.push(moved);
    }
    parts.join(", ")
}
