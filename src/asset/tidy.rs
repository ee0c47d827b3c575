//! Checks and repairs of a mesh as read: what leaves here is safe to intersect.

use glam::{DVec3, Vec3};

use super::flaw::Flaw;
use crate::geometry::Mesh;

/// Checks `mesh`, drops its degenerate triangles and gives unusable normals a value; returns the number dropped, which
/// may be all.
///
/// # Errors
/// Non-finite vertices, or indices out of range.
pub(super) fn tidy(mesh: &mut Mesh) -> Result<usize, Flaw> {
    check_positions(mesh)?;
    check_indices(mesh)?;
    let read = mesh.triangles.len();
    let positions = &mesh.positions;
    mesh.triangles.retain(|triangle| area_normal(positions, triangle) != DVec3::ZERO);
    repair_normals(mesh);
    Ok(read - mesh.triangles.len())
}

fn check_positions(mesh: &Mesh) -> Result<(), Flaw> {
    match mesh.positions.iter().position(|p| !Vec3::from(*p).is_finite()) {
        None => Ok(()),
        Some(vertex) => Err(Flaw::new(
            format!("vertex {vertex} is not finite: {:?}", mesh.positions.get(vertex).unwrap_or(&[0.0; 3])),
            "fix the vertex in the modelling program and export again",
        )),
    }
}

fn check_indices(mesh: &Mesh) -> Result<(), Flaw> {
    let count = mesh.positions.len();
    match mesh.triangles.iter().flatten().find(|&&index| index as usize >= count) {
        None => Ok(()),
        Some(index) => Err(Flaw::new(
            format!("vertex index {index} is out of range: there are {count} vertices"),
            "the file is damaged; export it again",
        )),
    }
}

/// Twice the area times the unit normal; zero if the triangle is degenerate or its area underflows.
fn area_normal(positions: &[[f32; 3]], triangle: &[u32; 3]) -> DVec3 {
    let [a, b, c] = triangle
        .map(|index| positions.get(index as usize).map_or(DVec3::ZERO, |p| Vec3::from(*p).as_dvec3()));
    (b - a).cross(c - a)
}

/// Normals that are zero or not finite become the area-weighted mean of their triangles' normals.
fn repair_normals(mesh: &mut Mesh) {
    let usable = |n: &[f32; 3]| Vec3::from(*n).try_normalize().is_some();
    if mesh.normals.iter().all(usable) {
        return;
    }
    let mut means = vec![DVec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let normal = area_normal(&mesh.positions, triangle);
        for &index in triangle {
            if let Some(mean) = means.get_mut(index as usize) {
                *mean += normal;
            }
        }
    }
    for (normal, mean) in mesh.normals.iter_mut().zip(means) {
        if !usable(normal) {
            *normal = mean.normalize_or(DVec3::Y).as_vec3().to_array();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Mesh {
        Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        }
    }

    #[test]
    fn degenerate_triangles_are_dropped_and_counted() {
        let mut mesh = Mesh { triangles: vec![[0, 1, 2], [0, 0, 1], [1, 1, 1]], ..triangle() };
        assert_eq!(tidy(&mut mesh), Ok(2));
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn a_mesh_of_degenerate_triangles_only_is_left_without_any() {
        let mut mesh = Mesh { triangles: vec![[0, 0, 1]], ..triangle() };
        assert_eq!(tidy(&mut mesh), Ok(1));
        assert!(mesh.triangles.is_empty());
    }

    #[test]
    fn bad_normals_become_those_of_the_triangles() {
        let mut mesh = Mesh { normals: vec![[f32::NAN; 3], [0.0; 3], [1.0, 0.0, 0.0]], ..triangle() };
        assert_eq!(tidy(&mut mesh), Ok(0));
        assert_eq!(mesh.normals, [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
    }

    #[test]
    fn nan_and_out_of_range_are_errors() {
        let mut mesh = triangle();
        mesh.positions[1][2] = f32::NAN;
        assert!(tidy(&mut mesh).unwrap_err().problem.contains("vertex 1 is not finite"));
        let mut mesh = Mesh { triangles: vec![[0, 1, 3]], ..triangle() };
        assert!(tidy(&mut mesh).unwrap_err().problem.contains("index 3 is out of range"));
    }
}
