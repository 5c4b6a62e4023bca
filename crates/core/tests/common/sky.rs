//! A sky of nine satellites, of which several programs take levels.

/// Azimuth and elevation in degrees, sigma in metres.
pub(crate) const SKY: [(f64, f64, f64); 9] = [
    (10.0, 70.0, 1.2),
    (65.0, 20.0, 2.0),
    (120.0, 45.0, 1.4),
    (170.0, 12.0, 3.1),
    (215.0, 33.0, 1.7),
    (260.0, 8.0, 3.9),
    (305.0, 55.0, 1.3),
    (345.0, 25.0, 1.9),
    (30.0, 40.0, 1.5),
];
