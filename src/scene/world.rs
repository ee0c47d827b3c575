//! The scene as authored: entities, and the tables that they share.

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::DAffine3;
use hecs::Entity;
use toml::Spanned;

use super::Settings;
use super::components::{
    AuthoredAt, CameraLens, HoleMark, LightShape, LocalTransform, MaterialHandle, MeshHandle, MeshShape,
    Name, OnFarSide, Parent,
};
use super::error::Fault;
use super::file::CameraTable;
use super::projection::{Orthographic, Perspective, Projection};
use crate::asset::{AssetError, Files, Model, ModelCamera, ModelNode, ModelView, load_gltf, load_obj};
use crate::geometry::Mesh;
use crate::shade::{Environment, Material, Texture};
use crate::spacetime::{Side, SpacetimeKind};

/// A scene before it is baked.
pub(super) struct World {
    /// Entities with the components of [`super::components`].
    pub entities: hecs::World,
    /// Meshes, by [`MeshHandle`].
    pub meshes: Vec<Mesh>,
    /// Materials, by [`MaterialHandle`].
    pub materials: Vec<Material>,
    /// Textures, as the maps of materials number them.
    pub textures: Vec<Texture>,
    /// Spacetime.
    pub spacetime: SpacetimeKind,
    /// Light from infinity.
    pub environment: Environment,
    /// Light from infinity on the far side of a wormhole.
    pub far_environment: Environment,
    /// Settings.
    pub settings: Settings,
    /// The camera written in the scene file itself.
    pub camera: Option<Entity>,
    /// What the scene file changes about the camera of a model.
    pub camera_changes: Option<Spanned<CameraTable>>,
    /// True if the scene file or an option says which spacetime there is.
    pub has_own_spacetime: bool,
    /// True if the scene file or an option says how large the picture is.
    pub has_own_size: bool,
    /// True if lights of a glTF file are scaled by the default factor, none being given.
    pub guesses_light_scale: bool,
    /// Content that is lost, one line each.
    pub warnings: Vec<String>,
    /// Choices made for want of being told, one line each.
    pub notes: Vec<String>,
    models: HashMap<PathBuf, LoadedModel>,
}

/// Nodes of a model whose meshes and materials are in the world's tables.
struct LoadedModel {
    nodes: Vec<ModelNode>,
    first_mesh: u32,
    first_material: u32,
}

/// The two kinds of geometry files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ModelFormat {
    /// Wavefront OBJ.
    Obj,
    /// glTF, text or binary.
    Gltf,
}

/// Settings of a scene file that override a model.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelOverrides {
    /// Replaces every material.
    pub material: Option<MaterialHandle>,
    /// Replaces the emission.
    pub emission: Option<glam::Vec3>,
    /// Factor on the lights: W/sr per candela, W/m² per lux.
    pub light_scale: f32,
    /// True if that is the default.
    pub guesses_light_scale: bool,
}

impl World {
    /// A world without entities.
    pub fn new(spacetime: SpacetimeKind, environment: Environment, settings: Settings) -> Self {
        Self {
            entities: hecs::World::new(),
            meshes: Vec::new(),
            materials: Vec::new(),
            textures: Vec::new(),
            spacetime,
            environment,
            far_environment: Environment::Black,
            settings,
            camera: None,
            camera_changes: None,
            has_own_spacetime: false,
            has_own_size: false,
            guesses_light_scale: false,
            warnings: Vec::new(),
            notes: Vec::new(),
            models: HashMap::new(),
        }
    }

    /// Adds a material to the table.
    pub fn add_material(&mut self, material: Material) -> MaterialHandle {
        self.materials.push(material);
        MaterialHandle((self.materials.len() - 1) as u32)
    }

    /// The material behind a handle.
    pub fn material(&self, handle: MaterialHandle) -> Material {
        self.materials.get(handle.0 as usize).copied().unwrap_or_default()
    }

    /// True if any surface or punctual light emits light.
    pub fn emits(&self) -> bool {
        let meshes = |shape: &MeshShape| shape.0.iter().any(|(_, material)| self.material(*material).emits());
        self.entities.query::<&MaterialHandle>().iter().any(|material| self.material(*material).emits())
            || self.entities.query::<&MeshShape>().iter().any(meshes)
            || self.entities.query::<&LightShape>().iter().any(|light| light.0.emits())
    }

    /// Spawns the nodes of a geometry file, `time` seconds after its animations started, under `parent`; each file is read
    /// once.
    ///
    /// The node `Lamp` is called `room/Lamp` if the scene file names the entity `room`, and `Lamp` if it has no name.
    pub fn spawn_model(
        &mut self,
        path: &Path,
        format: ModelFormat,
        parent: Entity,
        overrides: ModelOverrides,
        (files, time): (&Files, f64),
    ) -> Result<(), AssetError> {
        let loaded = match self.models.remove(path) {
            Some(loaded) => loaded,
            None => self.read_model(path, format, files, time)?,
        };
        let prefix = self.entities.get::<&Name>(parent).map(|name| name.0.clone()).unwrap_or_default();
        let mut changed = HashMap::new();
        let mut spawned: Vec<Entity> = Vec::with_capacity(loaded.nodes.len());
        for node in &loaded.nodes {
            let above = node.parent.and_then(|index| spawned.get(index).copied()).unwrap_or(parent);
            let parts = node.parts.iter().map(|part| {
                let own = MaterialHandle(loaded.first_material + part.material as u32);
                let material = *changed.entry(own).or_insert_with(|| self.restyled(own, overrides));
                (MeshHandle(loaded.first_mesh + part.mesh as u32), material)
            });
            let shape = MeshShape(parts.collect());
            let name = if prefix.is_empty() { node.name.clone() } else { format!("{prefix}/{}", node.name) };
            let light = node.light.map(|light| LightShape(light.scaled(overrides.light_scale)));
            self.guesses_light_scale |= light.is_some() && overrides.guesses_light_scale;
            spawned.push(self.spawn_node(node, name, above, shape, light));
        }
        self.models.insert(path.to_owned(), loaded);
        Ok(())
    }

    fn spawn_node(
        &mut self,
        node: &ModelNode,
        name: String,
        parent: Entity,
        shape: MeshShape,
        light: Option<LightShape>,
    ) -> Entity {
        let placed = (Parent(parent), LocalTransform(node.to_parent), Name(name));
        let entity = self.entities.spawn(placed);
        // The entity was spawned on the line above, so inserting cannot fail.
        if !shape.0.is_empty() {
            let _ = self.entities.insert_one(entity, shape);
        }
        if let Some(lens) = node.camera.and_then(lens) {
            let _ = self.entities.insert_one(entity, lens);
        }
        if let Some(light) = light {
            let _ = self.entities.insert_one(entity, light);
        }
        if let Some(hole) = node.hole {
            let _ = self.entities.insert_one(entity, HoleMark(hole));
        }
        entity
    }

    /// Puts an entity, and what is placed in its space, on a side of a wormhole.
    pub fn put(&mut self, entity: Entity, side: Side) {
        match side {
            Side::Near => {}
            Side::Far => {
                // An entity that does not exist is on no side.
                let _ = self.entities.insert_one(entity, OnFarSide);
            }
        }
    }

    /// Side of a wormhole that an entity is on.
    pub fn side(&self, entity: Entity) -> Side {
        let is_far = |entity: Entity| self.entities.get::<&OnFarSide>(entity).is_ok();
        let is_far = std::iter::once(entity).chain(self.ancestors(entity)).any(is_far);
        if is_far { Side::Far } else { Side::Near }
    }

    /// The entities above `entity`, nearest first.
    fn ancestors(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        let above = |entity: &Entity| self.entities.get::<&Parent>(*entity).ok().map(|parent| parent.0);
        std::iter::successors(above(&entity), move |entity| above(entity))
    }

    fn restyled(&mut self, own: MaterialHandle, overrides: ModelOverrides) -> MaterialHandle {
        let base = overrides.material.unwrap_or(own);
        match overrides.emission {
            None => base,
            Some(emission) => self.add_material(self.material(base).emitting(emission)),
        }
    }

    fn read_model(
        &mut self,
        path: &Path,
        format: ModelFormat,
        files: &Files,
        time: f64,
    ) -> Result<LoadedModel, AssetError> {
        let Model { mut meshes, mut materials, mut textures, nodes, mut warnings } = match format {
            ModelFormat::Obj => load_obj(path, files)?,
            ModelFormat::Gltf => load_gltf(path, files, time)?,
        };
        let loaded = LoadedModel {
            nodes,
            first_mesh: self.meshes.len() as u32,
            first_material: self.materials.len() as u32,
        };
        let first_texture = self.textures.len() as u32;
        materials.iter_mut().for_each(|material| *material = material.numbered_from(first_texture));
        self.textures.append(&mut textures);
        self.meshes.append(&mut meshes);
        self.materials.append(&mut materials);
        self.warnings.append(&mut warnings);
        Ok(loaded)
    }

    /// Spawns an entity of the scene file.
    pub fn spawn_authored(
        &mut self,
        span: Range<usize>,
        name: Option<String>,
        placement: DAffine3,
    ) -> Entity {
        let name = Name(name.unwrap_or_default());
        self.entities.spawn((AuthoredAt(span), name, LocalTransform(placement)))
    }

    /// Name of an entity, for messages and for the object-id AOV.
    pub fn name(&self, entity: Entity) -> String {
        let name = self.entities.get::<&Name>(entity).map(|name| name.0.clone()).unwrap_or_default();
        if name.is_empty() { format!("entity {}", entity.id()) } else { name }
    }

    /// One warning of what concerns several entities, if there are any.
    pub fn warn_of_names(&mut self, what: &str, names: &[String]) {
        /// Names listed in full before the line says how many more there are.
        const SHOWN: usize = 6;
        if names.is_empty() {
            return;
        }
        let shown = names.iter().take(SHOWN).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let more = match names.len().saturating_sub(SHOWN) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        self.warnings.push(format!("{what}: {shown}{more}"));
    }

    /// A fault of `entity`, at the place where it or the entity that it belongs to is written.
    pub fn fault(&self, entity: Entity, problem: &str, help: &str) -> Fault {
        let span = std::iter::once(entity)
            .chain(self.ancestors(entity))
            .find_map(|entity| self.entities.get::<&AuthoredAt>(entity).ok().map(|at| at.0.clone()));
        Fault::maybe_at(span, format!("`{}`: {problem}", self.name(entity)), help)
    }
}

/// Lens of a model's camera; `None` if its field of view is not usable.
fn lens(ModelCamera { view, aspect }: ModelCamera) -> Option<CameraLens> {
    let projection = match view {
        ModelView::Perspective { vertical_fov } => Projection::Perspective(Perspective::new(vertical_fov)?),
        ModelView::Orthographic { half_height } => Projection::Orthographic(Orthographic { half_height }),
    };
    Some(CameraLens { projection, near: 0.0, aspect })
}
