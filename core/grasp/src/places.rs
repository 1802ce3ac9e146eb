//! Where the published experiment put its tomato.

/// The published positions: x and y, robot frame, m. The nine by four grid of 10 cm as far as the right
/// arm reaches.
pub const PLACES_M: [[f64; 2]; 22] = [
    [0.2, -0.4],
    [0.3, -0.4],
    [0.2, -0.3],
    [0.3, -0.3],
    [0.4, -0.3],
    [0.2, -0.2],
    [0.3, -0.2],
    [0.4, -0.2],
    [0.2, -0.1],
    [0.3, -0.1],
    [0.4, -0.1],
    [0.2, 0.0],
    [0.3, 0.0],
    [0.4, 0.0],
    [0.2, 0.1],
    [0.3, 0.1],
    [0.4, 0.1],
    [0.2, 0.2],
    [0.3, 0.2],
    [0.4, 0.2],
    [0.2, 0.3],
    [0.3, 0.3],
];
