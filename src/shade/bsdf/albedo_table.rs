//! Tables of directional albedo: functions of a cosine and a roughness, interpolated by cubics.

/// Nodes along either axis.
const NODES: usize = 48;
/// Those and one beyond either end.
const PADDED: usize = NODES + 2;

/// Table of `N` functions of the cosine μ to the normal and of the roughness, both in [0, 1].
///
/// Nodes are even in ⁴√μ and in the root of the roughness: albedos change fastest at grazing angles and on smooth
/// surfaces.
pub struct AlbedoTable<const N: usize> {
    values: Vec<[f32; N]>,
}

impl<const N: usize> AlbedoTable<N> {
    /// The table of a function of μ > 0 and the roughness.
    pub fn new(mut function: impl FnMut(f64, f64) -> [f64; N]) -> Self {
        let node = |index: usize| (index as f64 - 1.0) / (NODES - 1) as f64;
        let inner = |index: usize| (1..=NODES).contains(&index);
        let mut values = vec![[0f32; N]; PADDED * PADDED];
        for (row, column) in (1..=NODES).flat_map(|row| (1..=NODES).map(move |column| (row, column))) {
            let value = function(node(column).powi(4), node(row) * node(row));
            values[row * PADDED + column] = value.map(|value| value as f32);
        }
        // Beyond the ends, lines go on straight.
        for row in (0..PADDED).filter(|&row| inner(row)) {
            extend(&mut values, row * PADDED, 1);
        }
        (0..PADDED).for_each(|column| extend(&mut values, column, PADDED));
        Self { values }
    }

    /// Values at a cosine and a roughness.
    #[inline(always)]
    pub fn at(&self, mu: f64, roughness: f64) -> [f64; N] {
        let (column, across) = place(mu.max(0.0).sqrt().sqrt());
        let (row, along) = place(roughness.max(0.0).sqrt());
        let (across, along) = (cubic(across), cubic(along));
        let mut sum = [0.0; N];
        for (i, weight_along) in along.iter().enumerate() {
            for (j, weight_across) in across.iter().enumerate() {
                let weight = weight_along * weight_across;
                let value = &self.values[(row + i) * PADDED + column + j];
                for (sum, value) in sum.iter_mut().zip(value) {
                    *sum += weight * f64::from(*value);
                }
            }
        }
        sum
    }
}

/// Extends a line of nodes from `start` by `stride` at both ends.
fn extend<const N: usize>(values: &mut [[f32; N]], start: usize, stride: usize) {
    for (outer, end, next) in [(0, 1, 2), (NODES + 1, NODES, NODES - 1)] {
        let [end, next] = [end, next].map(|index| values[start + index * stride]);
        values[start + outer * stride] = std::array::from_fn(|i| 2.0 * end[i] - next[i]);
    }
}

/// The first of the four nodes around a place in [0, 1], and the place between the second and the third.
#[inline(always)]
fn place(x: f64) -> (usize, f64) {
    let x = x.clamp(0.0, 1.0) * (NODES - 1) as f64;
    let node = (x as usize).min(NODES - 2);
    (node, x - node as f64)
}

/// Weights of four nodes: Catmull and Rom's spline.
#[inline(always)]
fn cubic(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (2.0 * t2 - t - t3),
        0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
        0.5 * (t + 4.0 * t2 - 3.0 * t3),
        0.5 * (t3 - t2),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_functions_are_found_between_nodes() {
        let exact = |mu: f64, roughness: f64| [mu.sqrt() + roughness * roughness, 1.0 - mu * roughness];
        let table = AlbedoTable::new(exact);
        for (i, j) in (0..=100).flat_map(|i| (0..=100).map(move |j| (i, j))) {
            let (mu, roughness) = (f64::from(i) / 100.0, f64::from(j) / 100.0);
            let error = |k: usize| (table.at(mu, roughness)[k] - exact(mu, roughness)[k]).abs();
            assert!(error(0) < 1e-3 && error(1) < 1e-3, "{mu} {roughness}: {} {}", error(0), error(1));
        }
        assert!(table.at(f64::NAN, 0.5)[0].is_finite());
    }
}
