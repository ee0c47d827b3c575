//! All integration tests, in one binary so that the suite links once; a module for each subject.

mod support;

mod geodesics {
    mod arcs;
    mod connections;
    mod conservation;
    mod extremes;
    mod field_connections;
    mod fields;
    mod geodesic_reference;
    mod gradient_index;
    mod kerr;
    mod kerr_connections;
    mod kerr_scenes;
    mod kerr_tolerance;
    mod schwarzschild_rays;
    mod spacetimes;
    mod steppers;
    mod tolerance;
    mod wormhole_rays;
}

mod geometry {
    mod bvh_oracle;
    mod coincident;
    mod grazing;
    mod leaks;
    mod scale;
}

mod light {
    mod absorption;
    mod chi_square;
    mod emitter_furnaces;
    mod field_flux;
    mod field_lights;
    mod footprints;
    mod furnace;
    mod irradiance;
    mod lamp_edges;
    mod light_density;
    mod light_noise;
    mod light_sampling;
    mod lights_near_the_hole;
    mod principled;
    mod regions;
    mod spinning_lights;
    mod sun_sky;
    mod textures;
}

mod pictures {
    mod background;
    mod cameras;
    mod determinism;
    mod einstein_ring;
    mod fields;
    mod flat_reference;
    mod golden;
    mod lensed_images;
    mod machines;
    mod spacetimes;
    mod spinning;
    mod wormholes;
}

mod files {
    mod fuzz;
    mod gltf_files;
    mod image_files;
    mod mtl_files;
    mod scene_errors;
}

mod commands {
    mod bench;
    mod cli;
    mod compare;
    mod connect;
    mod connect_several_holes;
    mod connect_spinning;
    mod connect_wormholes;
    mod endings;
    mod forecast;
    mod rays;
    mod reading;
    mod study;
    mod trace;
    mod trace_spinning;
    mod trace_wormhole;
}

mod project {
    mod circles;
    mod layers;
    mod nightly;
    mod readme;
    mod type_names;
}
