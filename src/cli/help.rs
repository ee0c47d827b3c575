//! Text below the flags in `--help`: examples and exit codes.

/// A subcommand's examples, and the exit codes.
macro_rules! below {
    ($($example:literal)*) => {
        concat!(
            "Examples:\n",
            $("  warpfront ", $example, "\n",)*
            "\nExit codes:\n",
            "  0        what was asked for is there\n",
            "  1        something was lost and --strict minds, pixels are without a sample,\n",
            "           or pictures differ by more than a flag allows\n",
            "  2        bad input\n",
            "  128 + N  ended by signal N: 130 by Ctrl-C (SIGINT), 143 by SIGTERM"
        )
    };
}

pub(super) const ALL: &str = below! {
    "info room.glb"
    "render room.glb --black-hole 0,1.2,0,0.1"
    "render scenes/einstein_ring.toml -o ring.exr --spp 32 --size 320x240"
    "compare draft.exr reference.exr"
    "help render"
};

pub(super) const RENDER: &str = below! {
    "render room.glb --black-hole 0,1.2,0,0.1 -o room.exr"
    "render scenes/einstein_ring.toml --spp 32 --size 320x240"
    "render scene.toml --quality draft --time-limit 30s"
    "render scene.toml --set camera.vertical_fov=50 --set film.width=1920"
    "render scene.toml --background transparent --aov depth,normal"
};

pub(super) const INFO: &str = below! {
    "info scenes/room_black_hole.toml"
    "info room.glb --size 1920x1080 --spp 256 --json"
};

pub(super) const COMPARE: &str = below! {
    "compare draft.exr reference.exr -o difference.exr --png difference.png"
    "compare new.exr old.exr --max-rmse 0.01"
};

pub(super) const RAYS: &str = below! {
    "rays scenes/accretion_disk.toml -o rays.svg"
    "rays room.glb --black-hole 0,1.2,0,0.1 -o rays.csv --count 11 --fan 60"
};

pub(super) const STUDY: &str = below! {
    "study scenes/cornell_black_hole.toml -o cornell"
    "study scenes/cornell_black_hole.toml --light-sampling off,straight,geodesic -o lights"
    "study --rays rays.csv -o orbits"
};

pub(super) const BENCH: &str = below! {
    "bench scenes/cornell_black_hole.toml --baseline per-pixel,paper,flat -o race"
    "bench scenes/cornell_black_hole.toml --sweep batch"
};

pub(super) const TRACE: &str = below! {
    "trace --spacetime schwarzschild rays.csv -o ends.csv"
};

pub(super) const CONNECT: &str = below! {
    "connect pairs.csv --max-winding 3 -o connections.csv"
};

pub(super) const COMPLETIONS: &str = below! {
    "completions bash > ~/.local/share/bash-completion/completions/warpfront"
    "completions zsh > ~/.zfunc/_warpfront"
    "completions fish > ~/.config/fish/completions/warpfront.fish"
};

pub(super) const MAN: &str = below! {
    "man | man -l -"
    "man render | man -l -"
    "man -o ~/.local/share/man/man1"
};
