//! Loss functions of residuals.

/// Squared lengths, in sigmas, of readings of one, two and three numbers at which Huber's loss turns from squares to
/// lengths: 5 % of Gaussian samples exceed it.
const HUBER: [f64; 3] = [3.84, 5.99, 7.81];
/// Degrees of freedom of Student's distribution.
const STUDENT: f64 = 5.0;

/// Loss of a whitened reading of up to three numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Loss {
    /// Squares: maximum likelihood for Gaussian noise.
    #[default]
    Gaussian,
    /// Huber 1964: squares up to a limit, lengths beyond.
    Huber,
    /// Student's t with five degrees of freedom (Lange, Little, Taylor 1989).
    StudentT,
}

impl Loss {
    /// The loss with this name: `gaussian`, `huber`, `student_t`.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "gaussian" => Some(Self::Gaussian),
            "huber" => Some(Self::Huber),
            "student_t" => Some(Self::StudentT),
            _ => None,
        }
    }

    /// Loss of a reading of so many numbers with squared length `square`.
    pub(crate) fn cost(self, square: f64, numbers: usize) -> f64 {
        let limit = HUBER[numbers.clamp(1, 3) - 1];
        match self {
            Self::Gaussian => square,
            Self::Huber if square <= limit => square,
            Self::Huber => 2.0 * (limit * square).sqrt() - limit,
            Self::StudentT => (STUDENT + numbers as f64) * (square / STUDENT).ln_1p(),
        }
    }

    /// Weight of its rows in iteratively reweighted least squares: slope of the loss over the square.
    pub(crate) fn weight(self, square: f64, numbers: usize) -> f64 {
        let limit = HUBER[numbers.clamp(1, 3) - 1];
        match self {
            Self::Gaussian => 1.0,
            Self::Huber if square <= limit => 1.0,
            Self::Huber => (limit / square).sqrt(),
            Self::StudentT => (STUDENT + numbers as f64) / (STUDENT + square),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_weight_is_the_slope_of_the_loss() {
        for loss in [Loss::Gaussian, Loss::Huber, Loss::StudentT] {
            for (square, numbers) in [(0.1, 3), (3.0, 2), (7.0, 3), (7.0, 2), (9.0, 3), (100.0, 3)]
            {
                let h = 1e-5;
                let cost = |square| loss.cost(square, numbers);
                let slope = (cost(square + h) - cost(square - h)) / (2.0 * h);
                let weight = loss.weight(square, numbers);
                assert!((slope - weight).abs() < 1e-7, "{loss:?} {square}");
            }
        }
    }
}
