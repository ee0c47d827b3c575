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

/// Textures of a material, each a factor on what it is named after.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Maps {
    /// Colour of the lobe.
    pub base_color: Option<TextureId>,
    /// Emitted radiance.
    pub emission: Option<TextureId>,
    /// True if vertex colours are a factor on the colour of the lobe.
    pub vertex_colors: bool,
}

impl Maps {
    /// True if the material is the same all over a surface.
    #[inline]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The same, with textures numbered from `first` on.
    pub fn numbered_from(self, first: u32) -> Self {
        let number = |texture: TextureId| texture.plus(first);
        let Self { base_color, emission, vertex_colors } = self;
        Self { base_color: base_color.map(number), emission: emission.map(number), vertex_colors }
    }

    /// Textures.
    pub fn textures(&self) -> impl Iterator<Item = TextureId> {
        let Self { base_color, emission, vertex_colors: _ } = *self;
        [base_color, emission].into_iter().flatten()
    }
}
