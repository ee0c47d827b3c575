//! Deformation of a primitive: morph targets move its vertices, and then the joints of a skin do.

use std::rc::Rc;

use glam::{DAffine3, DMat3, Vec3};
use gltf::accessor::Dimensions;
use gltf::mesh::Semantic;

use super::accessor::Column;
use super::buffers::Buffers;
use crate::asset::flaw::Flaw;

/// Sets of joints and weights that are read, of four each.
const SETS: u32 = 8;

/// Most morph targets of a mesh.
pub(super) const MOST_TARGETS: usize = 1 << 12;

/// Pose that a node gives to its mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct MeshPose {
    /// Weights of morph targets.
    pub weights: Vec<f32>,
    /// Index of the skin, and the matrices of its joints.
    pub skin: Option<(usize, Rc<[DAffine3]>)>,
}

/// Skin and bits of the weights: a mesh with the same ones looks the same.
pub(super) type PoseKey = (Option<usize>, Vec<u32>);

impl MeshPose {
    pub fn key(&self) -> PoseKey {
        let skin = self.skin.as_ref().map(|(index, _)| *index);
        (skin, self.weights.iter().map(|weight| weight.to_bits()).collect())
    }
}

/// The accessors that a deformation is made of, by index, and how.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct DeformationKey {
    /// Bits of the weight, positions, normals and tangents of each morph target in use.
    targets: Vec<(u32, [Option<usize>; 3])>,
    skin: Option<usize>,
    /// Joints and weights.
    sets: Vec<[Option<usize>; 2]>,
}

impl DeformationKey {
    pub fn new(primitive: &gltf::Primitive, pose: &MeshPose) -> Self {
        let index = |accessor: Option<gltf::Accessor>| accessor.map(|accessor| accessor.index());
        let targets = used_targets(primitive, pose).map(|(weight, target)| {
            let columns = [target.positions(), target.normals(), target.tangents()];
            (weight.to_bits(), columns.map(index))
        });
        let skin = pose.skin.as_ref().map(|(skin, _)| *skin);
        let sets = skin.map(|_| sets(primitive).map(|accessors| accessors.map(index)).collect());
        Self { targets: targets.collect(), skin, sets: sets.unwrap_or_default() }
    }
}

/// Morph targets in use, with their weights.
fn used_targets<'a>(
    primitive: &gltf::Primitive<'a>,
    pose: &MeshPose,
) -> impl Iterator<Item = (f32, gltf::mesh::MorphTarget<'a>)> {
    let weights = pose.weights.iter().copied();
    weights.zip(primitive.morph_targets()).filter(|(weight, _)| *weight != 0.0)
}

/// Joints and weights, as long as there are both or one is missing.
fn sets<'a>(primitive: &gltf::Primitive<'a>) -> impl Iterator<Item = [Option<gltf::Accessor<'a>>; 2]> {
    let set = |set| [Semantic::Joints(set), Semantic::Weights(set)].map(|semantic| primitive.get(&semantic));
    (0..SETS).map(set).take_while(|set| set.iter().any(Option::is_some))
}

/// A deformation in the bytes of a file.
pub(super) struct Deformation<'a> {
    positions: Vec<(f32, Column<'a>)>,
    normals: Vec<(f32, Column<'a>)>,
    tangents: Vec<(f32, Column<'a>)>,
    skin: Option<Skin<'a>>,
}

/// Joints and weights of vertices.
struct Skin<'a> {
    joints: Rc<[DAffine3]>,
    sets: Vec<[Column<'a>; 2]>,
}

impl<'a> Deformation<'a> {
    /// The deformation of a primitive of `count` vertices.
    pub fn open(
        primitive: &gltf::Primitive,
        pose: &MeshPose,
        buffers: &'a Buffers,
        count: usize,
    ) -> Result<Self, Flaw> {
        let open = |accessor: &gltf::Accessor, dimensions| {
            let column = Column::of_vectors(accessor, &[dimensions], buffers)?;
            match column.len() {
                len if len == count => Ok(column),
                len => Err(Flaw::new(
                    format!(
                        "accessor {} has {len} elements, but there are {count} vertices",
                        accessor.index()
                    ),
                    "the file is damaged; export it again",
                )),
            }
        };
        let [mut positions, mut normals, mut tangents] = [const { Vec::new() }; 3];
        for (weight, target) in used_targets(primitive, pose) {
            for (columns, accessor) in [
                (&mut positions, target.positions()),
                (&mut normals, target.normals()),
                (&mut tangents, target.tangents()),
            ] {
                if let Some(accessor) = accessor {
                    columns.push((weight, open(&accessor, Dimensions::Vec3)?));
                }
            }
        }
        let skin = match &pose.skin {
            None => None,
            Some((_, joints)) => {
                let both = |accessors: [Option<gltf::Accessor>; 2]| match accessors {
                    [Some(joints), Some(weights)] => {
                        Ok([open(&joints, Dimensions::Vec4)?, open(&weights, Dimensions::Vec4)?])
                    }
                    _ => Err(Flaw::new("joints or weights are missing", "export the file again")),
                };
                let sets: Vec<_> = sets(primitive).map(both).collect::<Result<_, _>>()?;
                if sets.is_empty() {
                    return Err(Flaw::new(
                        "the vertices have no joints and weights for the skin",
                        "export the mesh with its vertex groups, or without its armature",
                    ));
                }
                Some(Skin { joints: joints.clone(), sets })
            }
        };
        Ok(Self { positions, normals, tangents, skin })
    }

    /// Most bytes that are read for a vertex.
    pub fn bytes_of_each(&self) -> usize {
        let targets = self.positions.len() + self.normals.len() + self.tangents.len();
        12 * targets + self.skin.as_ref().map_or(0, |skin| 24 * skin.sets.len())
    }

    /// The position of a vertex that is stored at `stored`.
    pub fn position(&self, vertex: u32, stored: [f32; 3]) -> Result<[f32; 3], Flaw> {
        let morphed = morphed(&self.positions, vertex, stored);
        let matrix = self.matrix(vertex)?;
        Ok(matrix.map_or(morphed, |matrix| matrix.transform_point3(morphed.as_dvec3()).as_vec3()).to_array())
    }

    /// The normal, of any length, of a vertex that is stored with `stored`.
    pub fn normal(&self, vertex: u32, stored: [f32; 3]) -> Result<[f32; 3], Flaw> {
        let morphed = morphed(&self.normals, vertex, stored);
        let turned = |matrix: DAffine3| {
            let DMat3 { x_axis: x, y_axis: y, z_axis: z } = matrix.matrix3;
            // The inverse transposed, times the square of the determinant: also of a matrix that has no inverse.
            let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
            let normal = cofactors * morphed.as_dvec3();
            (normal * x.dot(y.cross(z)).signum()).normalize_or_zero().as_vec3()
        };
        Ok(self.matrix(vertex)?.map_or(morphed, turned).to_array())
    }

    /// The tangent of a vertex that is stored with `stored`.
    pub fn tangent(&self, vertex: u32, stored: [f32; 4]) -> Result<[f32; 4], Flaw> {
        let [x, y, z, sign] = stored;
        let morphed = morphed(&self.tangents, vertex, [x, y, z]);
        let matrix = self.matrix(vertex)?;
        if self.tangents.is_empty() && matrix.is_none() {
            return Ok(stored);
        }
        let turned = matrix.unwrap_or(DAffine3::IDENTITY).transform_vector3(morphed.as_dvec3());
        let [x, y, z] = turned.normalize_or_zero().as_vec3().to_array();
        Ok([x, y, z, sign])
    }

    /// Where the skin takes a vertex: the mean of its joints' matrices, or that of the first if no weight is above 0.
    fn matrix(&self, vertex: u32) -> Result<Option<DAffine3>, Flaw> {
        let Some(Skin { joints, sets }) = &self.skin else { return Ok(None) };
        let matrix = |joint: f32| {
            joints.get(joint as usize).ok_or_else(|| {
                let problem =
                    format!("vertex {vertex} hangs on joint {joint}, but the skin has {}", joints.len());
                Flaw::new(problem, "the file is damaged; export it again")
            })
        };
        let (mut sum, mut total) = (DAffine3::ZERO, 0.0);
        for [joints, weights] in sets {
            for (joint, weight) in joints.vector::<4>(vertex).into_iter().zip(weights.vector::<4>(vertex)) {
                if weight != 0.0 {
                    let (matrix, weight) = (matrix(joint)?, f64::from(weight));
                    sum.matrix3 += weight * matrix.matrix3;
                    sum.translation += weight * matrix.translation;
                    total += weight;
                }
            }
        }
        if total == 0.0 {
            let first = sets.first().map_or(0.0, |[joints, _]| joints.vector::<4>(vertex)[0]);
            return matrix(first).copied().map(Some);
        }
        Ok(Some(DAffine3 { matrix3: sum.matrix3 * total.recip(), translation: sum.translation / total }))
    }
}

fn morphed(targets: &[(f32, Column)], vertex: u32, stored: [f32; 3]) -> Vec3 {
    let moved = targets.iter().map(|(weight, column)| *weight * Vec3::from(column.vector::<3>(vertex)));
    moved.fold(Vec3::from(stored), |sum, moved| sum + moved)
}
