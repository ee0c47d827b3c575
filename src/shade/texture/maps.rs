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

/// Thickness of a thin film, by a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmMap {
    /// Thickness in its green channel.
    pub texture: TextureId,
    /// Thickness, nanometres, where that is 0 and where it is 1.
    pub range: [f32; 2],
}

/// Direction of an anisotropy in tangent space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnisotropyMap {
    /// Directions in the red and green channel, each from −1 to 1, and strength in the blue one.
    pub texture: Option<TextureId>,
    /// Sine and cosine of the angle by which they are turned, counter-clockwise from the tangent.
    pub rotation: [f32; 2],
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
    /// Roughness in the green channel, share of metal in the blue one.
    pub metallic_roughness: Option<TextureId>,
    /// Factor on a dielectric's reflectance, in the opacity.
    pub specular: Option<TextureId>,
    /// Colour of that reflectance.
    pub specular_color: Option<TextureId>,
    /// Share that light goes through, in the red channel.
    pub transmission: Option<TextureId>,
    /// Share that is coated, in the red channel.
    pub clearcoat: Option<TextureId>,
    /// Roughness of the coat, in the green channel.
    pub clearcoat_roughness: Option<TextureId>,
    /// Shading normals of the coat.
    pub clearcoat_normal: Option<NormalMap>,
    /// Colour of the sheen.
    pub sheen_color: Option<TextureId>,
    /// Roughness of the sheen, in the opacity.
    pub sheen_roughness: Option<TextureId>,
    /// Share that a thin film covers, in the red channel.
    pub iridescence: Option<TextureId>,
    /// Thickness of the film.
    pub film: Option<FilmMap>,
    /// Direction of an anisotropy.
    pub anisotropy: Option<AnisotropyMap>,
}

impl Maps {
    /// True if the material is the same all over a surface.
    #[inline]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
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
    pub fn numbered_from(mut self, first: u32) -> Self {
        self.each(|texture| *texture = texture.plus(first));
        self
    }

    /// Textures.
    pub fn textures(mut self) -> impl Iterator<Item = TextureId> {
        let mut all = Vec::new();
        self.each(|texture| all.push(*texture));
        all.into_iter()
    }

    /// Set of texture coordinates along which tangents are asked for, by `uv_set` of a texture.
    pub fn tangents_along(&self, uv_set: impl Fn(TextureId) -> Option<usize>) -> Option<usize> {
        let by_normals = self.normal.or(self.clearcoat_normal).and_then(|map| uv_set(map.texture));
        by_normals.or_else(|| self.anisotropy?.texture.map_or(Some(0), uv_set))
    }

    fn each(&mut self, mut act: impl FnMut(&mut TextureId)) {
        let Self {
            base_color,
            emission,
            normal,
            vertex_colors: _,
            metallic_roughness,
            specular,
            specular_color,
            transmission,
            clearcoat,
            clearcoat_roughness,
            clearcoat_normal,
            sheen_color,
            sheen_roughness,
            iridescence,
            film,
            anisotropy,
        } = self;
        let plain = [
            base_color,
            emission,
            metallic_roughness,
            specular,
            specular_color,
            transmission,
            clearcoat,
            clearcoat_roughness,
            sheen_color,
            sheen_roughness,
            iridescence,
        ];
        plain.into_iter().flatten().for_each(&mut act);
        [normal, clearcoat_normal].into_iter().flatten().for_each(|map| act(&mut map.texture));
        film.iter_mut().for_each(|map| act(&mut map.texture));
        anisotropy.iter_mut().filter_map(|map| map.texture.as_mut()).for_each(&mut act);
    }
}
