//! Map of the square to the disk that keeps neighbours and areas.
//!
//! Reference: Shirley, Chiu 1997, "A Low Distortion Map Between Disk and Square", JGT 2(3).

/// Polar coordinates on the disk of a point of the unit square: the square of the radius, in [0, 1), and the azimuth in
/// turns, in [0, 1]. Both are even, as the two numbers are, so that it may stand before any map that takes them so; but
/// what is well spread over the square stays so.
#[inline(always)]
pub fn concentric(u: f64, v: f64) -> [f64; 2] {
    let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let is_wide = x.abs() > y.abs();
    let (radius, across) = if is_wide { (x, y) } else { (y, -x) };
    let along = if radius == 0.0 { 0.0 } else { 0.125 * across / radius };
    // Middles of the sectors: to the right, up, to the left, down.
    let middle = if is_wide { 0.0 } else { 0.25 } + if radius < 0.0 { 0.5 } else { 0.0 };
    let turns = middle + along;
    [(radius * radius).min(1f64.next_down()), if turns < 0.0 { turns + 1.0 } else { turns }]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn neighbours_stay_neighbours_and_equal_cells_keep_equal_areas() {
        let place = |u: f64, v: f64| {
            let [square, turns] = concentric(u, v);
            assert!(
                (0.0..1.0).contains(&square) && (0.0..=1.0).contains(&turns),
                "{u} {v}: {square} {turns}"
            );
            let (sin, cos) = (TAU * turns).sin_cos();
            glam::DVec2::new(cos, sin) * square.sqrt()
        };
        const N: usize = 512;
        let step = 1.0 / N as f64;
        let mut counts = [0; 64];
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            let (u, v) = (i as f64 * step, j as f64 * step);
            let [right, up] = [place(u + step, v), place(u, v + step)].map(|at| at.distance(place(u, v)));
            assert!(right.max(up) < 3.0 * step, "{u} {v}: {right} {up}");
            let [square, turns] = concentric(u + 0.5 * step, v + 0.5 * step);
            counts[8 * (8.0 * square) as usize + (8.0 * turns) as usize % 8] += 1;
        }
        for count in counts {
            assert!((f64::from(count) * 64.0 / (N * N) as f64 - 1.0).abs() < 0.1, "{counts:?}");
        }
    }
}
