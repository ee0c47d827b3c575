//! Vertex attributes of meshes.

/// What vertices have beside positions and normals: only what a material asks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Sets of texture coordinates, each empty or with one per position.
    pub uvs: Vec<Vec<[f32; 2]>>,
    /// Linear colours and opacities; empty, or one per position.
    pub colors: Vec<[f32; 4]>,
    /// Unit tangents and the signs of bitangents, of the corners of each triangle; empty, or one row per triangle.
    pub tangents: Vec<[[f32; 4]; 3]>,
}

impl Attributes {
    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Heap memory, bytes.
    pub fn memory_bytes(&self) -> usize {
        self.uvs.iter().map(|set| size_of_val(set.as_slice())).sum::<usize>()
            + size_of_val(self.colors.as_slice())
            + size_of_val(self.tangents.as_slice())
    }
}
