//! A page as SVG.

use std::fmt::Write as _;

use crate::drawing::{Anchor, Color, Drawing, Mark};
use crate::font::Weight;

/// The page as an SVG element that stands by itself.
pub fn of(drawing: &Drawing) -> String {
    let (width, height) = (number(drawing.width), number(drawing.height));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}pt\" height=\"{height}pt\" viewBox=\"0 0 {width} {height}\" font-family=\"Inter, sans-serif\">\n"
    );
    for mark in &drawing.marks {
        write(&mut svg, mark);
    }
    svg.push_str("</svg>\n");
    svg
}

fn write(svg: &mut String, mark: &Mark) {
    match mark {
        Mark::Path { points, closed, fill, stroke } => {
            let mut path = String::new();
            for (i, [x, y]) in points.iter().enumerate() {
                let _ = write!(path, "{}{} {}", if i == 0 { "M" } else { "L" }, number(*x), number(*y));
            }
            if *closed {
                path.push('Z');
            }
            let _ = write!(svg, "<path d=\"{path}\"");
            match fill {
                Some((color, opacity)) => {
                    let _ = write!(svg, " fill=\"{}\"{}", hex(*color), opacity_of("fill-opacity", *opacity));
                }
                None => svg.push_str(" fill=\"none\""),
            }
            if let Some(stroke) = stroke {
                let _ = write!(
                    svg,
                    " stroke=\"{}\" stroke-width=\"{}\"{}",
                    hex(stroke.color),
                    number(stroke.width),
                    opacity_of("stroke-opacity", stroke.opacity)
                );
                if let Some([dash, gap]) = stroke.dash {
                    let _ = write!(svg, " stroke-dasharray=\"{} {}\"", number(dash), number(gap));
                }
            }
            svg.push_str("/>\n");
        }
        Mark::Circle { center: [x, y], radius, fill, opacity } => {
            let _ = writeln!(
                svg,
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"{}/>",
                number(*x),
                number(*y),
                number(*radius),
                hex(*fill),
                opacity_of("fill-opacity", *opacity)
            );
        }
        Mark::Text(text) => {
            let anchor = match text.anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            };
            let weight = match text.weight {
                Weight::Regular => "",
                Weight::SemiBold => " font-weight=\"600\"",
            };
            let _ = writeln!(
                svg,
                "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"{weight}{anchor}>{}</text>",
                number(text.at[0]),
                number(text.at[1]),
                number(text.size),
                hex(text.color),
                escaped(&text.text)
            );
        }
    }
}

/// Text as it may stand in XML and HTML, also inside of an attribute.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

fn hex(Color(r, g, b): Color) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

fn opacity_of(name: &str, opacity: f64) -> String {
    if opacity >= 1.0 { String::new() } else { format!(" {name}=\"{}\"", number(opacity)) }
}

/// At most two decimals; what is no number is nowhere on the page.
fn number(value: f64) -> String {
    let text = format!("{:.2}", if value.is_finite() { value } else { -1000.0 });
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
