//! Draws of a Dirichlet with few components, down to the smallest alphas.

use rand::RngExt;
use rand_distr::{Distribution, Gamma};

use crate::base::rng::Stream;

/// Fills `out` with a draw from the Dirichlet with these parameters, all above 0. The gammas are drawn as logarithms
/// (Gamma(a) = Gamma(a + 1) U^(1/a); Marsaglia and Tsang 2000), since those of small alphas vanish otherwise.
pub fn draw(random: &mut Stream, alphas: &[f64], out: &mut [f64]) {
    let mut most = f64::NEG_INFINITY;
    for (log, &alpha) in out.iter_mut().zip(alphas) {
        let gamma = Gamma::new(alpha + 1.0, 1.0).map_or(1.0, |gamma| gamma.sample(random));
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
