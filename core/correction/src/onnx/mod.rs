//! Networks as ONNX graphs, so that other programs can use them.
//!
//! ```text
//! touch_px [N,2] ─ Sub ─ Div ─┬─ Gemm ─ Relu|Tanh ─ Gemm ─┐ (one branch per network)
//!                             └─ …                       ─┴─ Sum ─ Mul ─ Add ─ sent_m [N,3]
//! ```
//!
//! 32-bit numbers, opset 13. An M2 has the output `[N,2]` (x, y); its heights, and the border of a
//! model, are JSON in the metadata (`plumbline_heights`, `plumbline_trust`).

mod proto;
mod read;
#[cfg(test)]
mod tests;
mod write;

/// Name of the input.
const INPUT: &str = "touch_px";
/// Name of the output.
const OUTPUT: &str = "sent_m";
/// Keys of the metadata.
const HEIGHTS: &str = "plumbline_heights";
const TRUST: &str = "plumbline_trust";
const SELF_TEST: &str = "plumbline_self_test";
const METHOD: &str = "plumbline_method";
