//! Null rays of a spinning hole, in Mino time λ.
//!
//! Future-directed photons in Cartesian Kerr–Schild coordinates of the ingoing form, in units of the hole's mass, with
//! the spin along z. With u = 1/r and the unit vector N of X = rN + a ẑ×N, both obey equations of second order with
//! polynomials on the right: u is a Binet oscillator, and N, independently, a point on the unit sphere in a quadratic
//! potential (Neumann's oscillator), apart from a winding about z that is an integral over u:
//!
//! ```text
//! u″ = −k² u + 3K u² − 2κ u³                     v = u′,  v² = U(u) = 1 − k²u² + 2Ku³ − κu⁴
//! N″ = −(J² + 2a²μ²) N + a²μ ẑ                   μ = N_z,  |N′|² = J² + a²μ²
//! φ′ = a (G − 1),  G = (p − v)/D = Ku²/(p + v),  p = 1 + a(a − L)u²,  D = 1 − 2u + (a² + e²)u²
//! ```
//!
//! with E = 1, L = (N×N′)_z, J² = |N′|² − a²μ², Q = J² − L², K = |N′ − a ẑ×N|², k² = J² − a², κ = a²Q + e²K. No roots,
//! no turning points, no poles and no horizon are singular. A step is a Taylor series whose harmonic part, which is all
//! there is in flat space, is split off and summed in closed form: straight lines are exact, the last coefficients tell
//! the length of the step, and the series is its own dense output.
//!
//! References: separation: Carter 1968, Phys. Rev. 174, 1559; λ: Mino 2003, Phys. Rev. D 67, 084027; Kerr–Schild:
//! Debney, Kerr, Schild 1969, J. Math. Phys. 10, 1842.

mod aim;
mod connection;
mod constants;
mod flow;
mod follow;
mod hamiltonian;
mod hole;
mod launch;
mod orbit_table;
mod photon;
mod place;
mod plane;
mod series;
mod state;
mod step;
mod time;

pub use aim::{Aimed, KerrPlace, turned, with_own_turn};
pub use connection::{KerrConnection, KerrConnector};
pub use constants::Constants;
pub use follow::{KerrEnd, KerrJourney, follow, follow_by};
pub use hamiltonian::{PhotonEnd, PhotonJourney, follow_photon};
pub use hole::UnitHole;
pub use launch::KerrLaunch;
pub use orbit_table::{OrbitTable, PlaneRay, TablePlace};
pub use photon::KerrPhoton;
pub use place::PlacedHole;
pub use plane::{OrbitPlane, PlaneOrbit, PlaneOrbitEnd};
pub use series::Series;
pub use state::MinoState;
pub use step::{SeriesControl, SeriesStep, dense_displacement};
pub use time::elapsed;
