//! The differences between all values of two samples in their order, without storing them: two samples of 700 have
//! 490,000 differences.

#[derive(Clone, Debug, PartialEq)]
pub struct PairwiseDifferences {
    a: Vec<f64>,
    b: Vec<f64>,
}

impl PairwiseDifferences {
    pub fn new(a: &[f64], b: &[f64]) -> PairwiseDifferences {
        let [a, b] = [a, b].map(|values| {
            let mut values = values.to_vec();
            values.sort_by(f64::total_cmp);
            values
        });
        PairwiseDifferences { a, b }
    }

    pub fn number(&self) -> usize {
        self.a.len() * self.b.len()
    }

    /// The difference at this index in ascending order; the index must be below [`PairwiseDifferences::number`].
    pub fn nth(&self, index: usize) -> f64 {
        // Bisection over all floats in their order: the least float that more than `index` differences do not exceed.
        let (mut low, mut high) = (0, u64::MAX);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.number_up_to(float_at(middle)) > index { high = middle } else { low = middle + 1 }
        }
        float_at(low)
    }

    /// The median of the differences; `None` without differences.
    pub fn median(&self) -> Option<f64> {
        let (number, middle) = (self.number(), self.number() / 2);
        match number {
            0 => None,
            odd if odd % 2 == 1 => Some(self.nth(middle)),
            _ => Some((self.nth(middle - 1) + self.nth(middle)) / 2.0),
        }
    }

    fn number_up_to(&self, limit: f64) -> usize {
        // The larger a is, the larger must b be, since rounding keeps the order of differences.
        let mut below = 0;
        let of_one = |a: &f64| {
            below += self.b[below..].iter().take_while(|b| (a - *b).total_cmp(&limit).is_gt()).count();
            self.b.len() - below
        };
        self.a.iter().map(of_one).sum()
    }
}

/// The float at this place in the order of `f64::total_cmp`.
fn float_at(place: u64) -> f64 {
    const SIGN: u64 = 1 << 63;
    f64::from_bits(if place & SIGN == 0 { !place } else { place ^ SIGN })
}
