//! Draws of a Dirichlet with few components, down to the smallest alphas.

use rand::RngExt;
use rand_distr::{Distribution, Gamma};

use crate::base::rng::Stream;

/// A Dirichlet to draw from again and again. The gammas are drawn as logarithms (Gamma(a) = Gamma(a + 1) U^(1/a); Marsaglia
/// and Tsang 2000), since those of small alphas vanish otherwise.
pub struct Gammas {
    /// Gamma(a + 1) and a, by component.
    of: Vec<(Option<Gamma<f64>>, f64)>,
}

impl Gammas {
    /// With these parameters, all above 0.
    pub fn new(alphas: &[f64]) -> Gammas {
        Gammas { of: alphas.iter().map(|&alpha| (Gamma::new(alpha + 1.0, 1.0).ok(), alpha)).collect() }
    }

    /// Fills `out` with a draw.
    pub fn draw(&self, random: &mut Stream, out: &mut [f64]) {
        let mut most = f64::NEG_INFINITY;
        for (log, (gamma, alpha)) in out.iter_mut().zip(&self.of) {
            let gamma = gamma.map_or(1.0, |gamma| gamma.sample(random));
            *log = gamma.ln() + (1.0 - random.random::<f64>()).ln() / alpha;
            most = most.max(*log);
        }
        let mut total = 0.0;
        for p in out.iter_mut() {
            *p = (*p - most).exp();
            total += *p;
        }
        out.iter_mut().for_each(|p| *p /= total);
    }
}
