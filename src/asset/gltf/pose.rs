//! Pose of a file: the places of all its nodes, from which skins take their joints.

use glam::DAffine3;

use super::accessor::Column;
use super::animation::Moment;
use super::buffers::Buffers;
use super::transform;
use crate::asset::flaw::Flaw;

/// Transforms of nodes into the space of the scene; `None` for a node that is its own ancestor or has no valid one.
pub(super) struct ScenePose {
    to_scene: Vec<Option<DAffine3>>,
}

impl ScenePose {
    /// The pose at a moment.
    pub fn new(gltf: &gltf::Gltf, moment: &Moment) -> Self {
        let nodes = || gltf.nodes();
        let mut is_child = vec![false; nodes().len()];
        nodes().flat_map(|node| node.children()).for_each(|child| is_child[child.index()] = true);
        let mut to_scene = vec![None; is_child.len()];
        let roots = nodes().filter(|node| !is_child[node.index()]);
        let mut open: Vec<_> = roots.map(|node| (node, DAffine3::IDENTITY)).collect();
        while let Some((node, above)) = open.pop() {
            let place = &mut to_scene[node.index()];
            let Ok(to_parent) = transform::of_node(&node, moment) else { continue };
            // A node with two parents is an error elsewhere.
            if place.is_none() {
                let own = above * to_parent;
                *place = Some(own);
                open.extend(node.children().map(|child| (child, own)));
            }
        }
        Self { to_scene }
    }

    /// For each joint of a skin, the matrix that takes what is bound to it to where it is in the scene.
    ///
    /// Goes by the JSON, since nothing has checked the indices.
    pub fn joints(&self, gltf: &gltf::Gltf, skin: usize, buffers: &Buffers) -> Result<Vec<DAffine3>, Flaw> {
        let help = "the file is damaged; export it again";
        let Some(skin) = gltf.document.as_json().skins.get(skin) else { return Ok(Vec::new()) };
        let binds = match &skin.inverse_bind_matrices {
            None => None,
            Some(index) => {
                let accessor = gltf.accessors().nth(index.value()).ok_or_else(|| {
                    Flaw::new(
                        format!("inverse bind matrices are accessor {index}, which does not exist"),
                        help,
                    )
                })?;
                Some(Column::of_matrices(&accessor, buffers)?)
            }
        };
        if let Some(few) = binds.as_ref().map(Column::len).filter(|count| *count < skin.joints.len()) {
            let problem = format!("there are {} joints, but {few} inverse bind matrices", skin.joints.len());
            return Err(Flaw::new(problem, help));
        }
        let joint = |(number, node): (u32, &gltf::json::Index<gltf::json::Node>)| {
            let place = self.to_scene.get(node.value()).copied().flatten();
            let place = place.ok_or_else(|| {
                let problem = format!("joint {number} is node {node}, which does not exist or has no place");
                Flaw::new(problem, help)
            })?;
            let bind = binds.as_ref().map(|binds| transform::of_matrix(&binds.matrix(number))).transpose()?;
            Ok(place * bind.unwrap_or(DAffine3::IDENTITY))
        };
        (0..).zip(&skin.joints).map(joint).collect()
    }
}
