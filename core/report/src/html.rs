//! A page as an HTML file.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::About;
use crate::drawing::Drawing;
use crate::font::{self, Weight};
use crate::svg::{self, escaped};

/// One file with all that it needs. Nothing in it runs and nothing is fetched, which the policy in
/// its head tells the browser, too.
pub fn of(drawing: &Drawing, about: &About) -> String {
    let title = escaped(&font::printable(&about.title));
    let description = escaped(&font::printable(&about.sentence));
    let face = |weight: Weight, number: u32| {
        format!(
            "@font-face{{font-family:Inter;font-weight:{number};src:url(data:font/ttf;base64,{}) format(\"truetype\")}}",
            STANDARD.encode(weight.data())
        )
    };
    let (regular, semi_bold) = (face(Weight::Regular, 400), face(Weight::SemiBold, 600));
    let page =
        svg::of(drawing).replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{description}\" "), 1);
    format!(
        "<!DOCTYPE html>
<html lang=\"en\">
<head>
<meta charset=\"utf-8\"/>
<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; font-src data:\"/>
<meta name=\"viewport\" content=\"width=device-width\"/>
<title>{title}</title>
<style>
{regular}
{semi_bold}
@page{{size:A4 portrait;margin:0}}
html{{background:#E6E9ED}}
body{{margin:0;padding:24px;display:flex;justify-content:center;font-kerning:normal}}
svg{{display:block;width:100%;max-width:900px;height:auto;background:#fff;box-shadow:0 1px 8px rgba(0,0,0,.18)}}
@media print{{html{{background:#fff}}body{{padding:0;display:block}}svg{{width:210mm;height:297mm;max-width:none;box-shadow:none;print-color-adjust:exact;-webkit-print-color-adjust:exact}}}}
</style>
</head>
<body>
{page}</body>
</html>
"
    )
}
