//! Every kind of finding on its page: complete, inside of the borders, nothing over each other.

use plumbline_gap::Finding;

use super::{HEIGHT, MARGIN, WIDTH, draw};
use crate::drawing::{Drawing, Mark, Text};
use crate::{ReportContext, html, pdf, sample, svg};

fn all() -> Vec<(&'static str, Finding)> {
    vec![
        ("named", sample::named()),
        ("class", sample::class()),
        ("not in library", sample::not_in_library()),
        ("no gap", sample::no_gap()),
        ("empty", sample::empty()),
        ("crowded", sample::crowded()),
        ("pixels", sample::pixels()),
    ]
}

fn contexts() -> [ReportContext; 2] {
    [sample::context(), ReportContext::default()]
}

fn texts(drawing: &Drawing) -> Vec<&Text> {
    drawing
        .marks
        .iter()
        .filter_map(|mark| match mark {
            Mark::Text(text) if !text.text.trim().is_empty() => Some(text),
            _ => None,
        })
        .collect()
}

fn with_doctype<'a>() -> roxmltree::ParsingOptions<'a> {
    roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() }
}

fn said(drawing: &Drawing) -> String {
    texts(drawing).iter().map(|text| text.text.as_str()).collect::<Vec<_>>().join(" ")
}

#[test]
fn no_text_leaves_the_page_or_lies_over_another() {
    for (name, finding) in all() {
        for context in contexts() {
            let drawing = draw(&finding, &context);
            let texts = texts(&drawing);
            let boxes: Vec<[f64; 4]> = texts
                .iter()
                .map(|text| {
                    let left = text.left();
                    [left, text.at[1] - 0.7 * text.size, left + text.width(), text.at[1] + 0.12 * text.size]
                })
                .collect();
            for (text, [left, top, right, bottom]) in texts.iter().zip(&boxes) {
                let inside = *left >= MARGIN - 0.5
                    && *right <= WIDTH - MARGIN + 0.5
                    && *top >= 20.0
                    && *bottom <= HEIGHT - 20.0;
                assert!(inside, "{name}: {text:?} leaves the page");
            }
            for (i, a) in boxes.iter().enumerate() {
                for (j, b) in boxes.iter().enumerate().skip(i + 1) {
                    let apart =
                        a[2] <= b[0] + 0.3 || b[2] <= a[0] + 0.3 || a[3] <= b[1] + 0.1 || b[3] <= a[1] + 0.1;
                    assert!(apart, "{name}: {:?} and {:?} lie over each other", texts[i], texts[j]);
                }
            }
        }
    }
}

#[test]
fn no_mark_leaves_the_paper() {
    for (name, finding) in all() {
        for mark in draw(&finding, &sample::context()).marks {
            let points = match &mark {
                Mark::Path { points, .. } => points.clone(),
                Mark::Circle { center, .. } => vec![*center],
                Mark::Text(_) => continue,
            };
            for [x, y] in points {
                let inside = (-0.01..=WIDTH + 0.01).contains(&x) && (-0.01..=HEIGHT + 0.01).contains(&y);
                assert!(inside, "{name}: {mark:?}");
            }
        }
    }
}

#[test]
fn the_page_says_what_was_found() {
    let said = said(&draw(&sample::named(), &ReportContext::default()));
    for part in [
        "2 missing effects",
        "Elbow: zero position off",
        "1.78 ± 0.17°",
        "97 %",
        "6.71 mm",
        "3.58 mm",
        "2.98 mm",
        "84 % of what can be closed",
        "with a weight of 250 g",
        "encoder says",
        "In the lab:",
        "5 folds of whole sets",
        "2026-11-20-touch-rich",
        "0.1.0",
        "1 outlier not used",
        "of error",
        "angle of the elbow in °",
    ] {
        assert!(said.contains(part), "{part} is missing in {said}");
    }
    assert!(!said.contains("rad "), "radians are for machines: {said}");
}

#[test]
fn what_an_effect_does_to_image_points_is_in_pixels() {
    let said = said(&draw(&sample::pixels(), &ReportContext::default()));
    assert!(said.contains("1.9 px in these rows") && !said.contains("mm in these rows"), "{said}");
}

#[test]
fn at_most_three_effects_are_told_and_values_that_may_be_zero_are_counted() {
    let crowded = said(&draw(&sample::crowded(), &ReportContext::default()));
    assert!(crowded.contains("and 4 smaller ones"), "{crowded}");
    let mut finding = sample::named();
    let mut other = finding.effects[0].parameters[0].clone();
    (other.value, other.low, other.high) = (0.0123, -0.01, 0.0346);
    finding.effects[0].parameters.push(other);
    let one = said(&draw(&finding, &ReportContext::default()));
    assert!(one.contains("1 other not told from zero") && !one.contains("0.7 ±"), "{one}");
    finding.effects[0].parameters.remove(0);
    let none = said(&draw(&finding, &ReportContext::default()));
    assert!(none.contains("size not told from zero") && !none.contains("0.7 ±"), "{none}");
}

#[test]
fn warnings_stand_beside_the_verdict_as_sentences() {
    let mut finding = sample::named();
    finding.warnings = vec!["there are too few repeats".to_owned(), "row 7 lies far off".to_owned()];
    let said = said(&draw(&finding, &ReportContext::default()));
    assert!(said.contains("Beside the verdict: There are too few repeats. Row 7 lies far off."), "{said}");
}

#[test]
fn each_verdict_has_its_own_words() {
    let says = |finding: &Finding, part: &str| {
        let said = said(&draw(finding, &sample::context()));
        assert!(said.contains(part), "{part} is missing in {said}");
    };
    says(&sample::no_gap(), "Model and measurement agree");
    says(&sample::no_gap(), "None is needed");
    let mut unknown_noise = sample::no_gap();
    unknown_noise.comparison.floor_from_repeats = false;
    unknown_noise.comparison.floor_source = plumbline_gap::finding::FloorSource::Fitted;
    says(&unknown_noise, "the noise is not known");
    says(&unknown_noise, "nothing tells how much of it is noise");
    says(&unknown_noise, "Measure one pose a few times");
    let said_of_it = said(&draw(&unknown_noise, &sample::context()));
    for wrong in ["agree", "None is needed", "Noise alone leaves as much", "Nothing above the noise"] {
        assert!(!said_of_it.contains(wrong), "{wrong} in {said_of_it}");
    }
    says(&sample::class(), "or as well: Shoulder, forward: encoder or gear off center");
    says(&sample::class(), "To tell them apart: repeat ten poses");
    says(&sample::class(), "Repeat 10 poses with a 250 g weight");
    says(&sample::not_in_library(), "A gap that no known effect explains");
    says(&sample::not_in_library(), "they do not explain it");
    says(&sample::not_in_library(), "2.9 mm × sin(3 × angle)");
    says(&sample::pixels(), "2.31 px");
    says(&sample::empty(), "no map can be drawn");
    says(&sample::crowded(), "smaller ones");
}

#[test]
fn html_and_svg_are_well_formed_and_carry_their_fonts() {
    for (name, finding) in all() {
        for context in contexts() {
            let page = html(&finding, &context);
            roxmltree::Document::parse_with_options(&page, with_doctype())
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(page.matches("data:font/ttf;base64,").count(), 2);
            assert!(
                !page.contains("http://") || page.matches("http://").count() == 1,
                "only the name of SVG"
            );
            let picture = svg(&finding, &context);
            roxmltree::Document::parse(&picture).unwrap_or_else(|e| panic!("{name}: {e}"));
        }
    }
}

#[test]
fn hostile_names_are_text() {
    let mut finding = sample::class();
    let hostile = "<script>alert(1)</script>\u{0}\u{202E} & \"quoted\" ' ]]> {{7*7}}";
    finding.rig = hostile.to_owned();
    finding.sentence = hostile.to_owned();
    finding.sessions = vec![hostile.to_owned()];
    finding.warnings = vec![hostile.to_owned()];
    finding.effects[0].title = hostile.to_owned();
    finding.effects[0].class[1].title = hostile.to_owned();
    finding.shown.covariates[0] = (hostile.to_owned(), hostile.to_owned());
    let mut context = sample::context();
    context.date = hostile.to_owned();
    context.model = hostile.to_owned();
    context.history[0].name = hostile.to_owned();
    let page = html(&finding, &context);
    assert!(!page.contains("<script") && !page.contains('\u{0}') && page.contains("&lt;script&gt;"));
    let document = roxmltree::Document::parse_with_options(&page, with_doctype()).expect("well formed");
    assert!(!document.descendants().any(|node| node.has_tag_name("script")));
    assert!(pdf(&finding, &context).is_ok());
}

#[test]
fn a_pdf_is_one_page_with_its_fonts() {
    for (name, finding) in all() {
        for context in contexts() {
            let file = pdf(&finding, &context).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(file.starts_with(b"%PDF-"), "{name}");
            let text = String::from_utf8_lossy(&file);
            assert_eq!(
                text.matches("/Type /Page\n").count() + text.matches("/Type/Page/").count(),
                1,
                "{name}"
            );
            assert!(text.contains("Inter") && text.contains("/FontFile"), "{name}");
            assert_eq!(file, pdf(&finding, &context).expect("again"), "{name}: the same file twice");
        }
    }
}

#[test]
fn numbers_that_are_none_do_not_reach_the_page() {
    let mut finding = sample::named();
    finding.shown.before = f64::NAN;
    finding.shown.floor = f64::INFINITY;
    finding.effects[0].probability = f64::NAN;
    finding.effects[0].size_m = f64::NAN;
    finding.comparison.residuals[0].before_m = [f64::NAN; 3];
    finding.comparison.residuals[1].covariates = vec![];
    finding.shown.telling = vec![0, 99];
    let said = said(&draw(&finding, &sample::context()));
    assert!(!said.contains("NaN") && !said.contains("inf"), "{said}");
    assert!(pdf(&finding, &sample::context()).is_ok());
}
