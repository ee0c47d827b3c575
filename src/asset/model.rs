//! A geometry file in memory: meshes, materials, and a tree of nodes that place them.

use glam::DAffine3;

use crate::geometry::Mesh;
use crate::light::Punctual;
use crate::shade::{Material, Texture};

/// Content of an OBJ or glTF file.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Meshes, each with one material; checked: finite, in range, no degenerate triangles, at least one triangle.
    pub meshes: Vec<Mesh>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures, as the maps of materials number them.
    pub textures: Vec<Texture>,
    /// Nodes; a parent comes before its children.
    pub nodes: Vec<ModelNode>,
    /// Features approximated or ignored, one line each.
    pub warnings: Vec<String>,
}

/// A named place in the tree.
#[derive(Clone, Debug, Default)]
pub struct ModelNode {
    /// Name in the file.
    pub name: String,
    /// Index of the parent in [`Model::nodes`].
    pub parent: Option<usize>,
    /// This node's space → the parent's.
    pub to_parent: DAffine3,
    /// Meshes placed here.
    pub parts: Vec<Part>,
    /// A camera placed here.
    pub camera: Option<ModelCamera>,
    /// A light placed here, in this node's space; photometric: candela, or lux if distant.
    pub light: Option<Punctual>,
    /// Black hole placed here.
    pub hole: Option<ModelHole>,
}

/// A mesh and its material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Index in [`Model::meshes`].
    pub mesh: usize,
    /// Index in [`Model::materials`].
    pub material: usize,
}

/// A camera that looks along −Z of its node, +Y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelCamera {
    /// Rays that it sees.
    pub view: ModelView,
    /// Width over height of the picture that it is meant for.
    pub aspect: Option<f64>,
}

/// Rays that a camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelView {
    /// Those through a pinhole.
    Perspective {
        /// Vertical field of view, radians, between 0 and π.
        vertical_fov: f64,
    },
    /// Parallel ones.
    Orthographic {
        /// Half of the height of what is seen, in units of the scene.
        half_height: f64,
    },
}

/// A black hole that a node places, its axis along the node's +Y: up in the program that exported it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelHole {
    /// Schwarzschild radius, in the node's units of length.
    pub radius: f64,
    /// Spin a/M.
    pub spin: f64,
}
