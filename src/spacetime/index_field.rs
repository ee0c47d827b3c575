//! Fields of refraction: static spacetimes without symmetry as an index n(x), many places at a time.

use glam::DVec3;

/// Numbers of `L` rays beside each other.
pub type Lanes<const L: usize> = [f64; L];
/// Vectors of `L` rays beside each other, by component.
pub type Vectors<const L: usize> = [[f64; L]; 3];

/// An index of refraction n(x) in three dimensions: n = Ψ/N of ds² = −N² dt² + Ψ² dx², or a lens.
///
/// Its rays obey x″ = ½∇n², |x′| = n in the parameter dσ = dl/n. They are followed in projective coordinates about the
/// start x₀ of each step: y = x − x₀, Y = y/(1 + β·y), in which straight lines are straight and infinity is at β·Y = 1.
/// With dτ = dσ/(1 + β·y)²,
///
/// ```text
/// d²Y/dτ² = (F − Y (β·F))/(1 − β·Y)³,  F = ½∇n²(x),
/// ```
///
/// whatever the `lean` β of the coordinates is: 0 leaves them as they are, and (x₀ − c)/(x₀ − c)² makes a force towards c
/// one in a single dimension, so that a ray from afar takes few steps.
pub trait IndexField: Clone + PartialEq + Send + Sync + 'static {
    /// The field where rays are, on their way in the directions of the momenta `p`.
    fn survey<const L: usize>(&self, x: &Vectors<L>, p: &Vectors<L>) -> FieldSurvey<L>;

    /// d²Y/dτ² at the projective places `y`, seen from the starts of steps.
    fn acceleration<const L: usize>(&self, from: &Viewpoint<L>, y: &Vectors<L>) -> Vectors<L>;

    /// Area in the static frame over area in the chart, Ψ².
    fn area_scale(&self, x: DVec3) -> f64;

    /// World position of its middle.
    fn middle(&self) -> DVec3;

    /// Distance from the middle outside which a ray that moves away from the middle never turns back.
    fn turning_radius(&self) -> f64;

    /// Places where rays end.
    fn sinks(&self) -> &[Sink];
}

/// The field where rays are.
#[derive(Clone, Copy, Debug)]
pub struct FieldSurvey<const L: usize> {
    /// n².
    pub index_squared: Lanes<L>,
    /// ½∇n².
    pub force: Vectors<L>,
    /// β of projective coordinates for a step from there.
    pub lean: Vectors<L>,
    /// Length over which the index changes.
    pub room: Lanes<L>,
    /// Length of the longest step that overlooks nothing.
    pub reach: Lanes<L>,
}

/// Starts of steps, from which projective coordinates count.
#[derive(Clone, Copy, Debug)]
pub struct Viewpoint<const L: usize> {
    /// Position.
    pub x: Vectors<L>,
    /// Momentum.
    pub p: Vectors<L>,
    /// β.
    pub lean: Vectors<L>,
}

/// A place where rays end: a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sink {
    /// World position.
    pub center: DVec3,
    /// Distance within which every ray that moves inwards is captured.
    pub captures: f64,
    /// Distance at which a ray has reached the horizon: nothing within is ever met.
    pub innermost: f64,
    /// Distance of circular rays, about.
    pub photon_sphere: f64,
    /// Critical impact parameter, about.
    pub shadow: f64,
}

/// Σ components.
#[inline(always)]
pub(crate) fn dot<const L: usize>(a: &Vectors<L>, b: &Vectors<L>) -> Lanes<L> {
    let mut dot = [0.0; L];
    for l in 0..L {
        dot[l] = a[0][l] * b[0][l] + a[1][l] * b[1][l] + a[2][l] * b[2][l];
    }
    dot
}
