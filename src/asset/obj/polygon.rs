//! Polygons → triangles.

use earcut::Earcut;
use glam::DVec3;

/// Most corners of a polygon that is cut by its ears, which takes time in proportion to their square.
const MOST_CORNERS: usize = 4096;

/// Part of a polygon's area that a fan's triangles may be turned by: corners are rounded.
const NEGLIGIBLE: f64 = 1e-6;

/// Cuts polygons; keeps its scratch space.
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    places: Vec<DVec3>,
    triangles: Vec<u32>,
    /// Corners of the triangles, as positions in the list of the polygons' corners.
    corners: Vec<u32>,
    /// Polygons that have dents and too many corners.
    left: usize,
}

/// Corners of triangles in place of polygons.
pub(super) struct Triangles {
    /// Three for each triangle: positions in the list of the polygons' corners.
    pub corners: Vec<u32>,
    /// Polygons that are cut into a fan although they have dents.
    pub left: usize,
}

/// Cuts polygons of `counts` corners each, of which `vertices` lists the vertices one polygon after the other.
pub(super) fn cut(positions: &[f32], vertices: &[u32], counts: &[u32]) -> Triangles {
    let (positions, _) = positions.as_chunks::<3>();
    let triangles = counts.iter().map(|count| count.saturating_sub(2) as usize).sum::<usize>();
    let mut cutter = Cutter {
        earcut: Earcut::new(),
        places: Vec::new(),
        triangles: Vec::new(),
        corners: Vec::with_capacity(3 * triangles),
        left: 0,
    };
    let (mut first, mut rest) = (0, vertices);
    for &count in counts {
        let Some((polygon, others)) = rest.split_at_checked(count as usize) else { break };
        let place =
            |vertex: &u32| positions.get(*vertex as usize).map(|place| DVec3::from(place.map(f64::from)));
        cutter.places.clear();
        cutter.places.extend(polygon.iter().filter_map(place));
        cutter.polygon(first);
        (first, rest) = (first + count, others);
    }
    Triangles { corners: cutter.corners, left: cutter.left }
}

impl Cutter {
    /// Cuts the polygon between `self.places`, whose first corner has the position `first`.
    fn polygon(&mut self, first: u32) {
        let normal = fan(&self.places).sum::<DVec3>();
        let turned = fan(&self.places).map(|triangle| (-triangle.dot(normal)).max(0.0)).sum::<f64>();
        let is_fan = turned <= NEGLIGIBLE * normal.length_squared();
        let is_cut = !is_fan && self.places.len() <= MOST_CORNERS && self.cut_ears(first, normal);
        if !is_cut {
            self.left += usize::from(!is_fan);
            let fan = (1..self.places.len().saturating_sub(1) as u32).flat_map(|b| [0, b, b + 1]);
            self.corners.extend(fan.map(|corner| first + corner));
        }
    }

    /// Cuts by ears in the plane of two axes that shows most of the polygon; whether there were any.
    fn cut_ears(&mut self, first: u32, normal: DVec3) -> bool {
        let size = normal.abs();
        let (u, v) = match size.max_element() {
            largest if largest == size.z => (DVec3::X, DVec3::Y),
            largest if largest == size.y => (DVec3::Z, DVec3::X),
            _ => (DVec3::Y, DVec3::Z),
        };
        let origin = self.places.first().copied().unwrap_or_default();
        let flat = self.places.iter().map(|place| [(place - origin).dot(u), (place - origin).dot(v)]);
        self.earcut.earcut(flat, &[], &mut self.triangles);
        // The crate's triangles turn from u to v, whichever way the polygon does.
        let turns_back = normal.dot(u.cross(v)) < 0.0;
        for &[a, b, c] in self.triangles.as_chunks().0 {
            let (b, c) = if turns_back { (c, b) } else { (b, c) };
            self.corners.extend([a, b, c].map(|corner| first + corner));
        }
        !self.triangles.is_empty()
    }
}

/// Twice the area times the normal of the triangles of a fan around the first corner.
fn fan(places: &[DVec3]) -> impl Iterator<Item = DVec3> {
    let apex = places.first().copied().unwrap_or_default();
    places.get(1..).unwrap_or_default().windows(2).map(move |edge| match edge {
        [b, c] => (b - apex).cross(c - apex),
        _ => DVec3::ZERO,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const L: [[f32; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

    /// Sums of the triangles' areas with and without their sign, relative to the first normal that is not 0.
    fn areas(places: &[[f32; 3]]) -> (f64, f64) {
        let vertices: Vec<u32> = (0..places.len() as u32).collect();
        let Triangles { corners, left } = cut(places.as_flattened(), &vertices, &[places.len() as u32]);
        assert_eq!(left, 0);
        let place = |corner: u32| DVec3::from(places[corner as usize].map(f64::from));
        let (triangles, _) = corners.as_chunks::<3>();
        let halves = triangles.iter().map(|[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|corner| place(*corner));
            (b - a).cross(c - a) / 2.0
        });
        let sum: DVec3 = halves.clone().sum();
        (sum.dot(DVec3::ONE), halves.map(DVec3::length).sum())
    }

    #[test]
    fn an_l_is_cut_right_from_any_corner_on_any_plane_either_way_round() {
        for plane in 0..3 {
            for turn in 0..6 {
                for is_reversed in [false, true] {
                    let mut places = L.map(|[x, y]| {
                        let mut place = [x, y, 0.5];
                        place.rotate_right(plane);
                        place
                    });
                    places.rotate_left(turn);
                    if is_reversed {
                        places.reverse();
                    }
                    let (signed, area) = areas(&places);
                    let expected = if is_reversed { -3.0 } else { 3.0 };
                    assert!((signed - expected).abs() < 1e-12, "{plane} {turn} {is_reversed}: {signed}");
                    assert!((area - 3.0).abs() < 1e-12, "{plane} {turn} {is_reversed}: {area}");
                }
            }
        }
    }

    #[test]
    fn a_quadrangle_with_a_dent_is_cut_along_the_other_diagonal() {
        let dart = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 2.0, 0.0]];
        for turn in 0..4 {
            let mut places = dart;
            places.rotate_left(turn);
            let (signed, area) = areas(&places);
            assert!((signed - 1.0).abs() < 1e-12 && (area - 1.0).abs() < 1e-12, "{turn}: {signed} {area}");
        }
    }

    #[test]
    fn convex_polygons_stay_fans_and_too_few_corners_give_nothing() {
        let positions = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let triangles = cut(positions.as_flattened(), &[0, 3, 1, 2, 0, 1, 2, 3], &[0, 1, 3, 4]);
        assert_eq!(triangles.corners, [1, 2, 3, 4, 5, 6, 4, 6, 7]);
    }

    #[test]
    fn a_round_polygon_of_very_many_corners_has_no_dents() {
        let place = |i: u32| {
            let angle = f64::from(i) * std::f64::consts::TAU / 50_000.0;
            [libm::cos(angle) as f32, libm::sin(angle) as f32, 0.0]
        };
        let places: Vec<[f32; 3]> = (0..50_000).map(place).collect();
        let (signed, area) = areas(&places);
        assert!(
            (signed - std::f64::consts::PI).abs() < 1e-5 && (area - signed).abs() < 1e-5,
            "{signed} {area}"
        );
    }

    #[test]
    fn a_dented_polygon_of_very_many_corners_becomes_a_fan_and_is_counted() {
        let place = |i: u32| [i as f32, if i.is_multiple_of(2) { 0.0 } else { 1e5 }, 0.0];
        let places: Vec<[f32; 3]> = (0..99_999).map(place).collect();
        let vertices: Vec<u32> = (0..99_999).collect();
        let triangles = cut(places.as_flattened(), &vertices, &[99_999]);
        assert_eq!((triangles.corners.len() / 3, triangles.left), (99_997, 1));
    }
}
