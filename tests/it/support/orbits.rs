//! What the tests of the march share: every stepper, rays followed with their sensitivity, and an exact swept angle
//! that knows nothing of steps.
#![allow(dead_code, unused_imports, unused_macros)] // Each test file is a crate of its own and uses a part of this.

use glam::DVec3;
use warpfront::geodesic::{Control, Journey, Launch, OrbitEnd, OrbitStepper, Phase, Step, follow};
use warpfront::math::dual::Dual;
use warpfront::math::real::Real;
use warpfront::spacetime::{ConformallyFlat, Fate, Schwarzschild};

/// Runs an expression with every stepper of orbits, under its name.
macro_rules! with_every_stepper {
    (|$name:ident, $stepper:ident| $body:expr) => {{
        use clap::ValueEnum;
        use warpfront::geodesic::{Dop853, Dopri5, Leapfrog4, Rk4, Rkf45, Rkn4, Rkn6};
        use warpfront::scene::StepperKind;
        for kind in StepperKind::value_variants() {
            with_every_stepper!(@of kind, $name, $stepper, $body; Rkn6 Dop853 Dopri5 Rkf45 Rkn4 Rk4 Leapfrog4);
        }
    }};
    (@of $kind:ident, $name:ident, $stepper:ident, $body:expr; $($stepper_type:ident)*) => {
        // Without a wildcard: a new stepper does not compile until it is in the list.
        match $kind {
            $(StepperKind::$stepper_type => {
                let ($name, $stepper) = (stringify!($stepper_type), $stepper_type);
                $body;
            })*
            // Know no orbits of these spacetimes.
            StepperKind::Series | StepperKind::Quadrature | StepperKind::Rk4Paper => {}
        }
    };
}
pub(crate) use with_every_stepper;

/// The state that a ray starts in.
pub fn start<M: ConformallyFlat, R: Real>(medium: &M, launch: &Launch) -> (R, Phase<R>, Fate) {
    (R::of(launch.b), Phase::new(medium, R::of(launch.w), R::of(launch.v)), launch.fate)
}

/// Follows a ray across the sphere of inverse radius `w_out`, without arcs; `each` sees the steps that are taken.
pub fn fly<M: ConformallyFlat, S: OrbitStepper, R: Real>(
    medium: &M,
    stepper: &S,
    tolerance: f64,
    launch: &Launch,
    w_out: f64,
    each: impl FnMut(&Step<R>),
) -> Journey<R> {
    let control = Control::new(medium, tolerance, f64::INFINITY);
    follow(medium, stepper, &control, start(medium, launch), w_out, each)
}

/// A ray that is followed together with its derivative by the angle at which it starts.
pub fn fly_with_derivative<M: ConformallyFlat, S: OrbitStepper>(
    medium: &M,
    stepper: &S,
    tolerance: f64,
    launch: &Launch,
    w_out: f64,
) -> Journey<Dual<f64>> {
    let Launch { b, w, v, fate, .. } = *launch;
    let dual = |value, slope| Dual { value, slope };
    // b = n sin χ / w, v = −n cos χ.
    let phase = Phase::new(medium, dual(w, 0.0), dual(v, b * w));
    let control = Control::new(medium, tolerance, f64::INFINITY);
    follow(medium, stepper, &control, (dual(b, -v / w), phase, fate), w_out, |_| ())
}

/// By how much an error of the initial angle grows until the end: in the place on the final sphere, in radians, or in
/// the direction there, and at least 1.
pub fn sensitivity(b: Dual<f64>, phase: &Phase<Dual<f64>>, swept: Dual<f64>) -> f64 {
    let slope = b * phase.w / -phase.v;
    let turned = swept.slope + slope.slope / (1.0 + slope.value * slope.value);
    swept.slope.abs().max(turned.abs()).max(1.0)
}

/// The sensitivity of a ray that escapes.
pub fn sensitivity_at_infinity<M: ConformallyFlat, S: OrbitStepper>(
    medium: &M,
    stepper: &S,
    launch: &Launch,
) -> Option<f64> {
    let journey = fly_with_derivative(medium, stepper, 1e-10, launch, 0.0);
    let OrbitEnd::Crosses(phase, swept) = journey.end else { return None };
    Some(sensitivity(Dual { value: launch.b, slope: -launch.v / launch.w }, &phase, swept))
}

/// The swept angle, if the ray escapes.
pub fn swept<R: Real>(journey: &Journey<R>) -> Option<f64> {
    match journey.end {
        OrbitEnd::Crosses(_, swept) => Some(swept.value()),
        _ => None,
    }
}

/// A ray towards the sphere of critical rays around the hole: impact parameter `b` as near as the direction allows.
pub fn aimed(medium: &Schwarzschild, rho: f64, b: f64, outwards: bool) -> DVec3 {
    let n = medium.index(1.0 / rho);
    let sine = (b / (n * rho)).min(1.0);
    let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
    DVec3::new(if outwards { cosine } else { -cosine }, sine, 0.0)
}

/// A number of the complex plane, as far as the roots of a cubic need one.
#[derive(Clone, Copy)]
struct Complex(f64, f64);

impl Complex {
    fn times(self, other: Complex) -> Complex {
        Complex(self.0 * other.0 - self.1 * other.1, self.0 * other.1 + self.1 * other.0)
    }

    /// The root in the right half-plane.
    fn sqrt(self) -> Complex {
        let length = self.0.hypot(self.1);
        let larger = (0.5 * (length + self.0.abs())).sqrt();
        if larger == 0.0 {
            return Complex(0.0, 0.0);
        }
        let smaller = 0.5 * self.1 / larger;
        if self.0 >= 0.0 { Complex(larger, smaller) } else { Complex(smaller.abs(), larger.copysign(self.1)) }
    }
}

/// Carlson's R_F(x, y, z) of three numbers ≥ 0, or with z the conjugate of y, by duplication \[DLMF 19.36.1\].
fn carlson(x: f64, y: Complex, z: Complex) -> f64 {
    let (mut x, mut y, mut z) = (x, y, z);
    for _ in 0..100 {
        let (rx, ry, rz) = (x.sqrt(), y.sqrt(), z.sqrt());
        let yz = ry.times(rz);
        // Real in both cases.
        let sum = rx * (ry.0 + rz.0) + yz.0;
        (x, y, z) = (
            0.25 * (x + sum),
            Complex(0.25 * (y.0 + sum), 0.25 * y.1),
            Complex(0.25 * (z.0 + sum), 0.25 * z.1),
        );
        let mean = (x + y.0 + z.0) / 3.0;
        let spread = (1.0 - x / mean)
            .abs()
            .max((1.0 - y.0 / mean).hypot(y.1 / mean))
            .max((1.0 - z.0 / mean).hypot(z.1 / mean));
        if spread < 2e-3 {
            let (a, b, c) = (
                Complex(1.0 - x / mean, 0.0),
                Complex(1.0 - y.0 / mean, -y.1 / mean),
                Complex(1.0 - z.0 / mean, -z.1 / mean),
            );
            let e2 = a.times(b).0 + b.times(c).0 + c.times(a).0;
            let e3 = a.times(b.times(c)).0;
            let series = 1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 * e2 * e3 / 44.0;
            return series / mean.sqrt();
        }
    }
    f64::NAN
}

/// The exact angle that a ray sweeps from its start to infinity around a hole, by Carlson's elliptic integral of the
/// areal orbit (du/dφ)² = 1/b² − u² + r_s u³; nothing if it does not escape.
///
/// The orbit's cubic and its roots \[Darwin 1959\] share nothing with the isotropic equations that are stepped.
pub fn exact_sweep(medium: &Schwarzschild, launch: &Launch) -> Option<f64> {
    let (b, a) = (launch.b, medium.horizon());
    if launch.fate == Fate::Falls {
        return None;
    }
    if b == 0.0 {
        return Some(0.0);
    }
    let q = 1.0 + a * launch.w;
    let u = launch.w / (q * q);
    // Radii at which b²(du/dφ)² = Π (1 − r u) vanishes.
    let critical = medium.critical_impact_parameter();
    let scale = 2.0 * b / 3f64.sqrt();
    let third = |sign: f64, angle: f64| scale * ((std::f64::consts::PI + sign * angle) / 3.0).cos();
    let over_sqrt3 = |x: f64| x * 3f64.sqrt();
    let offset = ((b - critical) * (b + critical)).abs().sqrt();
    if b >= critical {
        let angle = offset.atan2(critical);
        let roots = [-scale * (angle / 3.0).cos(), third(-1.0, angle), third(1.0, angle)];
        let mut below = roots.map(|root| 1.0 - root * u);
        if launch.w < 1.0 / medium.photon_sphere() {
            // The factor that vanishes at the turning point, from the rate dw/dψ.
            let rate = launch.v * (1.0 - a * launch.w) / (q * q * q);
            below[1] = rate * rate / (below[0] * below[2]);
        }
        let real = |x: f64| Complex(x, 0.0);
        // Between two places where the factors are x and y, `apart` in u.
        let integral = |x: [f64; 3], y: [f64; 3], apart: f64| {
            let (x, y) = (x.map(|f| f.max(0.0).sqrt()), y.map(|f| f.max(0.0).sqrt()));
            let u =
                |i: usize, j: usize, k: usize| ((x[i] * x[j] * y[k] + y[i] * y[j] * x[k]) / apart).powi(2);
            2.0 * b * carlson(u(0, 1, 2), real(u(0, 2, 1)), real(u(1, 2, 0)))
        };
        if launch.v <= 0.0 {
            return Some(integral(below, [1.0; 3], u));
        }
        let nearest = roots.map(|root| 1.0 - root / roots[1]);
        let nearest = [nearest[0], 0.0, nearest[2]];
        Some(integral(nearest, [1.0; 3], 1.0 / roots[1]) + integral(nearest, below, below[1] / roots[1]))
    } else {
        let angle = (offset / b).asinh();
        let pair =
            Complex(0.5 * scale * (angle / 3.0).cosh(), 0.5 * over_sqrt3(scale) * (angle / 3.0).sinh());
        let single = -scale * (angle / 3.0).cosh();
        let x0 = (1.0 - single * u).sqrt();
        let x1 = Complex(1.0 - pair.0 * u, -pair.1 * u).sqrt();
        // With conjugate roots; all factors are 1 at infinity.
        let conjugate = |z: Complex| Complex(z.0, -z.1);
        let over = |z: Complex| Complex(z.0 / u, z.1 / u);
        let u01 = over(Complex(x0 * x1.0 + x1.0, x0 * x1.1 - x1.1));
        let u12 = (x1.times(conjugate(x1)).0 + x0) / u;
        let u01 = u01.times(u01);
        Some(2.0 * b * carlson(u12 * u12, u01, conjugate(u01)))
    }
}
