//! Draws from a Dirichlet with few components, numerically stable for small alphas.

use rand::RngExt;
use rand_distr::{Distribution, Gamma};

use crate::base::rng::Stream;

/// Sampler of one Dirichlet. Gamma variates are drawn as logarithms (Gamma(a) = Gamma(a + 1) U^(1/a); Marsaglia and
/// Tsang 2000), since variates with small alphas would underflow.
pub struct DirichletSampler {
    /// For each component, the distribution Gamma(a + 1), and the parameter a itself.
    of: Vec<(Option<Gamma<f64>>, f64)>,
}

impl DirichletSampler {
    /// The sampler of the Dirichlet with these alphas, all above 0.
    pub fn new(alphas: &[f64]) -> DirichletSampler {
        DirichletSampler { of: alphas.iter().map(|&alpha| (Gamma::new(alpha + 1.0, 1.0).ok(), alpha)).collect() }
    }

    /// Fills `out` with a draw from the Dirichlet.
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
