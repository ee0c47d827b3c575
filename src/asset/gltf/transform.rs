//! Transforms of nodes and instances.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

use super::animation::Moment;
use crate::asset::flaw::Flaw;

/// Node space → parent space at a moment; a matrix cannot be animated.
pub(super) fn of_node(node: &gltf::Node, moment: &Moment) -> Result<DAffine3, Flaw> {
    match node.transform() {
        gltf::scene::Transform::Matrix { matrix } => of_matrix(&matrix),
        gltf::scene::Transform::Decomposed { translation, rotation, scale } => {
            let index = node.index();
            of_parts(
                moment.translation(index).unwrap_or(translation),
                moment.rotation(index).unwrap_or(rotation),
                moment.scale(index).unwrap_or(scale),
            )
        }
    }
}

/// The affine part of a matrix by columns.
pub(super) fn of_matrix(columns: &[[f32; 4]; 4]) -> Result<DAffine3, Flaw> {
    let matrix = DMat4::from_cols_array_2d(&columns.map(|column| column.map(f64::from)));
    finite(DAffine3 { matrix3: DMat3::from_mat4(matrix), translation: matrix.w_axis.truncate() })
}

/// Scale, then rotation (a quaternion of any length but 0), then translation.
pub(super) fn of_parts(translation: [f32; 3], rotation: [f32; 4], scale: [f32; 3]) -> Result<DAffine3, Flaw> {
    let rotation = DQuat::from_array(rotation.map(f64::from));
    let length = rotation.length();
    if !(length.is_finite() && length > 0.0) {
        return Err(Flaw::new("the rotation is not a quaternion", "export the file again"));
    }
    finite(DAffine3::from_scale_rotation_translation(
        DVec3::from(scale.map(f64::from)),
        rotation / length,
        DVec3::from(translation.map(f64::from)),
    ))
}

fn finite(transform: DAffine3) -> Result<DAffine3, Flaw> {
    if transform.is_finite() {
        Ok(transform)
    } else {
        Err(Flaw::new("the transform is not finite", "reset the node's transform and export again"))
    }
}
