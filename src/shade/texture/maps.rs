//! Maps of a material: the textures by which its factors vary over a surface.

/// A texture, by its number among the scene's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureId(pub u32);

impl TextureId {
    /// The texture so many after.
    pub fn plus(self, count: u32) -> Self {
        Self(self.0 + count)
    }
}

/// A texture of normals in tangent space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// Normals, each component from −1 to 1.
    pub texture: TextureId,
    /// Factor on the first two.
    pub scale: f32,
}

/// Part of a material on which vertex colours are a factor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VertexColors {
    /// None.
    #[default]
    Nothing,
    /// Colour of the lobe.
    BaseColor,
    /// Emitted radiance.
    Emission,
}

/// Textures of a material, each a factor on what it is named after.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Maps {
    /// Colour of the lobe.
    pub base_color: Option<TextureId>,
    /// Emitted radiance.
    pub emission: Option<TextureId>,
    /// Shading normals.
    pub normal: Option<NormalMap>,
    /// Part on which vertex colours are a factor.
    pub vertex_colors: VertexColors,
}

impl Maps {
    /// True if the material is the same all over a surface.
    #[inline]
    pub fn is_empty(&self) -> bool {
        let Self { base_color, emission, normal, vertex_colors } = self;
        let has_textures = base_color.is_some() | emission.is_some() | normal.is_some();
        !has_textures && *vertex_colors == VertexColors::Nothing
    }

    /// The same, but for what is a factor on emitted radiance.
    pub fn without_emission(self) -> Self {
        let vertex_colors = match self.vertex_colors {
            VertexColors::Emission => VertexColors::Nothing,
            others => others,
        };
        Self { emission: None, vertex_colors, ..self }
    }

    /// The same, with textures numbered from `first` on.
    pub fn numbered_from(self, first: u32) -> Self {
        let number = |texture: TextureId| texture.plus(first);
        let Self { base_color, emission, normal, vertex_colors } = self;
        let normal = normal.map(|map| NormalMap { texture: number(map.texture), ..map });
        Self { base_color: base_color.map(number), emission: emission.map(number), normal, vertex_colors }
    }

    /// Textures.
    pub fn textures(&self) -> impl Iterator<Item = TextureId> {
        let Self { base_color, emission, normal, vertex_colors: _ } = *self;
        [base_color, emission, normal.map(|map| map.texture)].into_iter().flatten()
    }
}
