//! Cross-sections of the primitives in a plane.

use glam::DVec3;

use super::scene::{Geometry, Item};
use super::{Disk, Sphere};

/// A plane, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point of it.
    pub point: DVec3,
    /// Unit normal.
    pub normal: DVec3,
}

/// A piece of the outline of a primitive's intersection with a plane, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CrossSection {
    /// From one point to the other.
    Line([DVec3; 2]),
    /// A circle in the plane.
    Circle {
        /// Centre.
        center: DVec3,
        /// Radius.
        radius: f64,
    },
}

/// Sine of the angle between a disk and a plane, and height relative to the disk's size, below which the disk lies in
/// the plane.
const IN_PLANE: f64 = 1e-9;

impl Plane {
    fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }

    fn cut_sphere(&self, sphere: &Sphere) -> Option<CrossSection> {
        let height = self.height(sphere.center);
        let radius2 = (sphere.radius - height) * (sphere.radius + height);
        let center = sphere.center - height * self.normal;
        (radius2 > 0.0).then(|| CrossSection::Circle { center, radius: radius2.sqrt() })
    }

    /// A disk in the plane gives its rims; any other a line, in two pieces if it crosses the hole in the middle.
    fn cut_disk(&self, disk: &Disk) -> Vec<CrossSection> {
        let along = self.normal.cross(disk.normal);
        let height = self.height(disk.center);
        if along.length() < IN_PLANE {
            let rims =
                if height.abs() <= IN_PLANE * disk.outer { [disk.outer, disk.inner] } else { [0.0; 2] };
            let circle = |radius| CrossSection::Circle { center: disk.center, radius };
            return rims.into_iter().filter(|&radius| radius > 0.0).map(circle).collect();
        }
        let sine = along.length();
        let along = along / sine;
        // Down the disk to where the line of both planes passes its centre.
        let down = disk.normal.cross(along);
        let distance = -height / self.normal.dot(down);
        let nearest = disk.center + distance * down;
        let half = |radius: f64| (radius * radius - distance * distance).max(0.0).sqrt();
        let (outer, inner) = (half(disk.outer), half(disk.inner));
        let line = |from: f64, to: f64| CrossSection::Line([nearest + from * along, nearest + to * along]);
        match (outer, inner) {
            (0.0, _) => Vec::new(),
            (outer, 0.0) => vec![line(-outer, outer)],
            (outer, inner) => vec![line(-outer, -inner), line(inner, outer)],
        }
    }

    /// Nothing for a triangle in the plane: its neighbours across the plane draw its edges.
    fn cut_triangle(&self, corners: [DVec3; 3]) -> Option<CrossSection> {
        let heights = corners.map(|corner| self.height(corner));
        let crossing = |i: usize, j: usize| {
            let (a, b) = (heights[i], heights[j]);
            ((a >= 0.0) != (b >= 0.0)).then(|| corners[i].lerp(corners[j], a / (a - b)))
        };
        // Signs differ on two edges or none.
        let mut ends = [(0, 1), (1, 2), (2, 0)].into_iter().filter_map(|(i, j)| crossing(i, j));
        Some(CrossSection::Line([ends.next()?, ends.next()?]))
    }
}

impl Geometry {
    /// The outlines of all that `plane` cuts.
    pub fn cross_section(&self, plane: &Plane) -> Vec<CrossSection> {
        let local = Plane { point: plane.point - self.origin, ..*plane };
        let mut cuts = Vec::new();
        for (slot, item) in self.members() {
            match item {
                Item::Sphere(i) => cuts.extend(local.cut_sphere(&self.spheres[i as usize].0)),
                Item::Disk(i) => cuts.extend(local.cut_disk(&self.disks[i as usize].0)),
                Item::Triangle(_) => cuts.extend(local.cut_triangle(self.triangle(slot).corners())),
                Item::Instance(i) => {
                    let placed = &self.placed[i as usize];
                    let Some(shared) = &self.shared[placed.mesh as usize] else { continue };
                    let to_local = placed.to_object.inverse();
                    let place = |corner| to_local.transform_point3(corner);
                    let triangles = shared.triangles().map(|(_, triangle)| triangle.corners().map(place));
                    cuts.extend(triangles.filter_map(|corners| local.cut_triangle(corners)));
                }
            }
        }
        cuts.into_iter().map(|cut| cut.moved(self.origin)).collect()
    }
}

impl CrossSection {
    fn moved(self, by: DVec3) -> Self {
        match self {
            CrossSection::Line(ends) => CrossSection::Line(ends.map(|end| end + by)),
            CrossSection::Circle { center, radius } => CrossSection::Circle { center: center + by, radius },
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::geometry::{Instance, Mesh, Primitives, Surface};

    const GROUND: Plane = Plane { point: DVec3::ZERO, normal: DVec3::Y };
    const SURFACE: Surface = Surface { material: 0, entity: 0 };

    fn line(cut: CrossSection) -> [DVec3; 2] {
        let CrossSection::Line(mut ends) = cut else { panic!("{cut:?} is no line") };
        ends.sort_by(|a, b| a.x.total_cmp(&b.x));
        ends
    }

    #[test]
    fn a_sphere_is_cut_in_a_circle_or_not_at_all() {
        let sphere = |y: f64| Sphere { center: DVec3::new(1.0, y, 2.0), radius: 5.0 };
        let expected = CrossSection::Circle { center: DVec3::new(1.0, 0.0, 2.0), radius: 4.0 };
        assert_eq!(GROUND.cut_sphere(&sphere(3.0)), Some(expected));
        assert_eq!(GROUND.cut_sphere(&sphere(-5.5)), None);
    }

    #[test]
    fn an_annulus_is_cut_in_two_lines_one_or_none() {
        let tilted = DVec3::new(0.0, 0.6, 0.8);
        let at = |center: DVec3| GROUND.cut_disk(&Disk { center, normal: tilted, inner: 3.0, outer: 5.0 });
        let through_the_middle = at(DVec3::ZERO);
        assert_eq!(through_the_middle.len(), 2);
        let mut xs: Vec<f64> =
            through_the_middle.iter().flat_map(|&cut| line(cut)).map(|end| end.x).collect();
        xs.sort_by(f64::total_cmp);
        assert!(xs.iter().zip([-5.0, -3.0, 3.0, 5.0]).all(|(x, e)| (x - e).abs() < 1e-12), "{xs:?}");
        // Four up along the disk, which rises by 0.8 per unit.
        let beside = at(DVec3::new(0.0, 3.2, 0.0));
        let [from, to] = line(beside[0]);
        assert!(beside.len() == 1 && (from.x + 3.0).abs() < 1e-12 && (to.x - 3.0).abs() < 1e-12);
        assert!(from.y.abs() < 1e-12 && tilted.dot(from - DVec3::new(0.0, 3.2, 0.0)).abs() < 1e-12);
        assert!(at(DVec3::new(0.0, 4.1, 0.0)).is_empty());
    }

    #[test]
    fn an_annulus_in_the_plane_shows_its_rims() {
        let disk = Disk { center: DVec3::X, normal: -DVec3::Y, inner: 1.0, outer: 2.0 };
        let circle = |radius| CrossSection::Circle { center: DVec3::X, radius };
        assert_eq!(GROUND.cut_disk(&disk), [circle(2.0), circle(1.0)]);
        assert!(GROUND.cut_disk(&Disk { center: DVec3::Y, ..disk }).is_empty());
    }

    #[test]
    fn triangles_are_cut_alike_whether_placed_once_or_shared() {
        let mesh = Mesh {
            positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let placed = |x: f64| {
            let to_world = DAffine3::from_translation(DVec3::new(x, 0.0, 100.0));
            (Instance { mesh: 0, to_world }, SURFACE)
        };
        for count in 1..3 {
            let instances = (0..count).map(|index| placed(10.0 * f64::from(index))).collect();
            let primitives = Primitives { meshes: vec![mesh.clone()], instances, ..Primitives::default() };
            let cuts = Geometry::build(primitives).cross_section(&GROUND);
            assert_eq!(cuts.len(), count as usize);
            let nearest = cuts.into_iter().map(line).min_by(|a, b| a[0].x.total_cmp(&b[0].x)).unwrap();
            let expected = [DVec3::new(-0.5, 0.0, 100.0), DVec3::new(0.5, 0.0, 100.0)];
            assert!(nearest.iter().zip(expected).all(|(a, b)| a.distance(b) < 1e-6), "{nearest:?}");
        }
    }
}
