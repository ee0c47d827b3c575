//! Material of a surface: one lobe and an emission, which textures may vary.

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::bsdf::{Diffuse, Lacquered, Lobe, Principled, Variation};
use super::media::InterfaceCrossing;
use super::texture::{
    AnisotropyMap, FilmMap, Footprint, Maps, NormalMap, Opacity, Texture, TextureId, VertexColors,
};
use crate::geometry::MeshPoint;

/// A material: a lobe and what the surface emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Scattering lobe.
    pub lobe: Lobe,
    /// Share of light that is absorbed inside of it per length that observers at rest measure, if that is short.
    pub attenuation: Vec3,
    /// Emitted radiance, the same in all directions.
    pub emission: Vec3,
    /// True if the back of the surface (against its normal) emits as well.
    pub emits_both_sides: bool,
    /// Textures that are factors on these.
    pub maps: Maps,
    /// Opacity; `None` if it is 1 all over.
    pub opacity: Option<Opacity>,
}

impl Default for Material {
    /// Diffuse grey of albedo 0.8, glTF's and Blender's look for "no material".
    fn default() -> Self {
        Self {
            lobe: Lobe::Diffuse(Diffuse { albedo: Vec3::splat(0.8) }),
            attenuation: Vec3::ZERO,
            emission: Vec3::ZERO,
            emits_both_sides: true,
            maps: Maps::default(),
            opacity: None,
        }
    }
}

impl Material {
    /// The material at a point of a mesh, seen in a footprint, by textures numbered as its maps say.
    pub fn at(&self, point: &MeshPoint, footprint: Footprint, textures: &[Texture]) -> Self {
        let maps = &self.maps;
        let look = |map| look_up(map, point, footprint.scattering, textures);
        let mut base_color = look(maps.base_color);
        if maps.vertex_colors == VertexColors::BaseColor {
            base_color *= point.color();
        }
        let [mr, sheen_roughness] = [maps.metallic_roughness, maps.sheen_roughness].map(look);
        let thickness = |FilmMap { texture, range: [least, most] }: FilmMap| {
            least + (most - least) * look(Some(texture)).y
        };
        let anisotropy = maps.anisotropy.map_or((1.0, None), |map| anisotropy(&map, point, look));
        let variation = Variation {
            color: base_color.truncate(),
            metallic: mr.z,
            roughness: mr.y,
            specular: look(maps.specular).w,
            specular_color: look(maps.specular_color).truncate(),
            transmission: look(maps.transmission).x,
            clearcoat: look(maps.clearcoat).x,
            clearcoat_roughness: look(maps.clearcoat_roughness).y,
            sheen_color: look(maps.sheen_color).truncate(),
            sheen_roughness: sheen_roughness.w,
            iridescence: look(maps.iridescence).x,
            film_thickness: maps.film.map(thickness),
            anisotropy: anisotropy.0,
            tangent: anisotropy.1,
        };
        let emission = self.emission_at(point, footprint.emission, textures);
        Self { lobe: self.lobe.varied(&variation), emission, ..*self }
    }

    /// Radiance that is emitted at a point of a mesh, seen in a footprint of a width (scene units).
    pub fn emission_at(&self, point: &MeshPoint, width: f64, textures: &[Texture]) -> Vec3 {
        let mut factor = look_up(self.maps.emission, point, width, textures);
        if self.maps.vertex_colors == VertexColors::Emission {
            factor *= point.color();
        }
        self.emission * factor.truncate()
    }

    /// Unit shading normal in the world at a point of a mesh, if a texture tells.
    pub fn normal_at(&self, point: &MeshPoint, footprint: Footprint, textures: &[Texture]) -> Option<DVec3> {
        normal_by(self.maps.normal?, point, footprint.scattering, textures)
    }

    /// That of the coat.
    pub fn clearcoat_normal_at(
        &self,
        point: &MeshPoint,
        footprint: Footprint,
        textures: &[Texture],
    ) -> Option<DVec3> {
        normal_by(self.maps.clearcoat_normal?, point, footprint.scattering, textures)
    }

    /// The material with a coat that has a normal of its own, where a map bends normals of one of both.
    pub fn with_coat_apart(self) -> Self {
        let are_apart = self.maps.normal.is_some() || self.maps.clearcoat_normal.is_some();
        match self.lobe {
            Lobe::Principled(principled) if are_apart && principled.clearcoat > 0.0 => {
                let lobe = Lobe::Lacquered(Lacquered { principled, clearcoat_normal: DVec3::ZERO });
                Self { lobe, ..self }
            }
            Lobe::Principled(_)
            | Lobe::Diffuse(_)
            | Lobe::Mirror(_)
            | Lobe::Dielectric(_)
            | Lobe::Lacquered(_) => self,
        }
    }

    /// The same with textures numbered from `first` on.
    pub fn numbered_from(&self, first: u32) -> Self {
        let moved = |opacity: Opacity| Opacity {
            map: opacity.map.map(|(texture, channel)| (texture.plus(first), channel)),
            ..opacity
        };
        Self { maps: self.maps.numbered_from(first), opacity: self.opacity.map(moved), ..*self }
    }

    /// Textures that it looks at.
    pub fn textures(&self) -> impl Iterator<Item = TextureId> {
        self.maps.textures().chain(self.opacity.and_then(|opacity| opacity.map).map(|(texture, _)| texture))
    }

    /// The same with another emission all over.
    pub fn emitting(&self, emission: Vec3) -> Self {
        Self { emission, maps: self.maps.without_emission(), ..*self }
    }

    /// True if the surface emits light at all.
    pub fn emits(&self) -> bool {
        self.emission != Vec3::ZERO
    }

    /// True if the emission is not the same all over a surface.
    pub fn emission_varies(&self) -> bool {
        self.maps.emission.is_some() || self.maps.vertex_colors == VertexColors::Emission
    }

    /// True if light from one direction leaves in many: light sampling helps.
    pub fn spreads_light(&self) -> bool {
        !self.lobe.is_specular() && self.lobe.albedo() != Vec3::ZERO
    }

    /// True if the surface scatters no light, and looks the same all over.
    pub fn only_emits(&self) -> bool {
        let is_black = matches!(self.lobe, Lobe::Diffuse(Diffuse { albedo }) if albedo == Vec3::ZERO);
        is_black && self.maps.is_empty() && self.opacity.is_none()
    }

    /// True if light from one direction leaves in one or two and no others: a mirror, glass.
    pub fn is_specular(&self) -> bool {
        self.lobe.is_specular()
    }

    /// True if no lamp is seen at the surface, wherever that is looked at: it does not emit, nor do textures make it a
    /// mirror or glass. Not inline, so that what most paths need stays in registers.
    #[inline(never)]
    pub fn shows_no_lamps(&self) -> bool {
        let spreads = matches!(self.lobe, Lobe::Diffuse(_)) || (self.maps.is_empty() && !self.is_specular());
        spreads && !self.emits()
    }

    /// True if light enters what is beyond the surface.
    pub fn is_dielectric(&self) -> bool {
        self.lobe.ior().is_some()
    }

    /// The material with light that microfacets scatter more than once given back, or not.
    pub fn with_multiscatter(self, multiscatter: bool) -> Self {
        match self.lobe {
            Lobe::Principled(lobe) => {
                Self { lobe: Lobe::Principled(Principled { multiscatter, ..lobe }), ..self }
            }
            Lobe::Lacquered(lobe) => {
                let principled = Principled { multiscatter, ..lobe.principled };
                Self { lobe: Lobe::Lacquered(Lacquered { principled, ..lobe }), ..self }
            }
            Lobe::Diffuse(_) | Lobe::Mirror(_) | Lobe::Dielectric(_) => self,
        }
    }

    /// The colour that the albedo AOV shows.
    pub fn albedo(&self) -> Vec3 {
        self.lobe.albedo()
    }
}

/// Share of light that a medium absorbs per length, if that is short: it leaves `colour` after `distance`.
pub fn attenuation(colour: Vec3, distance: f32) -> Vec3 {
    colour.map(|share| if share < 1.0 { -libm::logf(share.max(f32::MIN_POSITIVE)) / distance } else { 0.0 })
}

/// Factor on what a map varies at a point of a mesh: 1 without one.
fn look_up(map: Option<TextureId>, point: &MeshPoint, width: f64, textures: &[Texture]) -> Vec4 {
    map.map_or(Vec4::ONE, |TextureId(id)| textures[id as usize].at(point, width))
}

/// Unit normal in the world at a point of a mesh, as a texture tells.
fn normal_by(map: NormalMap, point: &MeshPoint, width: f64, textures: &[Texture]) -> Option<DVec3> {
    let NormalMap { texture: TextureId(id), scale } = map;
    let texel = textures[id as usize].at(point, width);
    let [x, y, z] = (2.0 * texel.truncate() - 1.0).to_array();
    point.from_tangent_space([scale * x, scale * y, z].map(f64::from))
}

/// Factor on the strength of an anisotropy, and its direction in the world, as textures tell by `look`.
fn anisotropy(
    map: &AnisotropyMap,
    point: &MeshPoint,
    look: impl Fn(Option<TextureId>) -> Vec4,
) -> (f32, Option<DVec3>) {
    let AnisotropyMap { texture, rotation: [sin, cos] } = *map;
    let (direction, strength) = match texture {
        Some(_) => {
            let texel = look(texture);
            (2.0 * texel.truncate().truncate() - 1.0, texel.z)
        }
        None => (Vec2::X, 1.0),
    };
    let turned = Vec2::new(cos, sin).rotate(direction);
    (strength, point.from_tangent_space([turned.x.into(), turned.y.into(), 0.0]))
}

/// Index of refraction of what light goes into through faces of `materials`, relative to that of what it comes from.
pub fn relative_index(materials: &[Material], crossing: &InterfaceCrossing) -> f64 {
    let index = |medium: Option<u32>| {
        medium.and_then(|medium| materials[medium as usize].lobe.ior()).map_or(1.0, f64::from)
    };
    index(crossing.into.current()) / index(crossing.from)
}
