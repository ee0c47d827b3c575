//! Kerr's spacetime of a spinning hole: [`KerrNewman`] without charge.

use super::kerr_newman::{KerrNewman, SPIN};
use super::named::Named;
use super::parameter::{Parameter, SCHWARZSCHILD_RADIUS};

/// A spinning hole without charge, as scenes and tables name it.
pub struct Kerr(KerrNewman);

impl From<Kerr> for KerrNewman {
    fn from(Kerr(hole): Kerr) -> Self {
        hole
    }
}

impl Named for Kerr {
    const NAME: &'static str = "kerr";
    const TITLE: &'static str = "Kerr";
    const SUMMARY: &'static str = "A hole of spin `a` (a/M) along z and Schwarzschild radius `rs` (2M; 2 if absent) at the origin; Cartesian Kerr–Schild coordinates";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter { in_tables: Some(2.0), ..SCHWARZSCHILD_RADIUS }, SPIN];

    fn new(values: &[f64]) -> Self {
        Self(KerrNewman::new(values[0], values[1], 0.0))
    }

    fn values(&self) -> Vec<f64> {
        self.0.values()[..2].to_vec()
    }
}
