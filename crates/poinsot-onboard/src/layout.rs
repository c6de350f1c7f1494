//! Places of the columns.

use crate::configuration::{Configuration, INPUTS};
use crate::numbers::{AXES, CURVE, MOUNTING, NUMBERS, PARAMETERS, WHEELS};
use poinsot_dynamics::propagation::{COLUMN, Column, INTERNAL, STATE};

/// Components of the kernels' state `[dphi_B, dp_N, dP_N, dh_N]` in the order of the filter's columns; without a position the first six
/// count. Amplitude and momentum of each mode follow.
const FREE: [usize; STATE] = [0, 1, 2, 9, 10, 11, 3, 4, 5, 6, 7, 8];
pub const ROTATION: usize = 6;

/// Places of the columns.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    /// Errors of the inputs that have noise, the first columns.
    inputs: [usize; INPUTS],
    input_count: usize,
    /// Components of the kernels' state, in the order of the columns, then the others.
    pub state: [usize; COLUMN],
    state_count: usize,
    /// Modes.
    pub modes: usize,
    /// Uncertain numbers, the last columns, and how many of them are unknown, the first ones.
    pub numbers: usize,
    pub unknown: usize,
    places: [usize; NUMBERS],
}

impl Layout {
    pub const NONE: Self = Self {
        inputs: [0; INPUTS],
        input_count: 0,
        state: [0; COLUMN],
        state_count: 0,
        modes: 0,
        numbers: 0,
        unknown: 0,
        places: [0; NUMBERS],
    };

    pub fn new(configuration: &Configuration) -> Self {
        let mut layout = Self {
            modes: configuration.modes().len(),
            unknown: configuration
                .uncertain()
                .filter(|k| *k < PARAMETERS)
                .count(),
            ..Self::NONE
        };
        let free = if configuration.translates() {
            STATE
        } else {
            ROTATION
        };
        let used = STATE + 2 * layout.modes;
        let state = FREE.into_iter().take(free).chain(STATE..used);
        let others = FREE.into_iter().skip(free).chain(used..COLUMN);
        for (place, component) in layout.state.iter_mut().zip(state.chain(others)) {
            *place = component;
        }
        layout.state_count = free + used - STATE;
        let noisy = (0..INPUTS).filter(|k| configuration.input_noise(*k) > 0.0);
        for (place, k) in layout.inputs.iter_mut().zip(noisy) {
            *place = k;
            layout.input_count += 1;
        }
        for (place, k) in layout.places.iter_mut().zip(configuration.uncertain()) {
            *place = k;
            layout.numbers += 1;
        }
        layout
    }

    /// Indices of the inputs with noise.
    pub fn inputs(&self) -> &[usize] {
        &self.inputs[..self.input_count]
    }

    /// How many of them are wheels, the first ones.
    pub fn wheels(&self) -> usize {
        self.inputs().iter().filter(|k| **k < WHEELS).count()
    }

    /// Indices of the uncertain numbers.
    pub fn numbers(&self) -> &[usize] {
        &self.places[..self.numbers]
    }

    /// Indices of the unknown ones.
    pub fn unknown(&self) -> &[usize] {
        &self.places[..self.unknown]
    }

    /// Columns of the turn of the attitude sensor.
    pub fn mountings(&self) -> impl Iterator<Item = usize> + Clone {
        let numbers = self.numbers().iter().enumerate();
        let first = numbers.filter(|(_, k)| (MOUNTING..CURVE).contains(*k));
        let theta = self.theta();
        first.map(move |(j, _)| theta + j)
    }

    /// Components of the kernels' state, in the order of the columns.
    pub fn state(&self) -> &[usize] {
        &self.state[..self.state_count]
    }

    /// First column of the modes.
    pub fn internal(&self) -> usize {
        self.bias() - 2 * self.modes
    }

    /// First column of the state.
    pub fn pose(&self) -> usize {
        self.input_count
    }

    /// The components of the state in a row over the columns.
    pub fn of_row<'a, const N: usize>(&self, row: &'a [f64; N]) -> &'a [f64] {
        &row[self.pose()..self.bias()]
    }

    /// Those of a column of the kernels, in the order of a row.
    pub fn of_column(&self, column: &Column) -> [f64; COLUMN] {
        let mut out = [0.0; COLUMN];
        for (to, component) in out.iter_mut().zip(self.state()) {
            *to = column.data.0[0][*component];
        }
        out
    }

    /// First column of the gyro bias.
    pub fn bias(&self) -> usize {
        self.pose() + self.state().len()
    }

    /// First column of the numbers.
    pub fn theta(&self) -> usize {
        self.bias() + AXES
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.theta() + self.numbers
    }
}

/// Columns that any configuration with exact known numbers fits into: the state with a position and modes, the bias, all parameters and
/// the curve of the wheels, a column more for each input at the other end of an interval and for the mean of each wheel, the noises of both
/// momenta and of the bias, and `z`. Known numbers have room where there are wheels or joints alone.
pub const COLUMNS: usize =
    INPUTS + STATE + INTERNAL + AXES + PARAMETERS + 1 + INPUTS + WHEELS + 3 * AXES + 1;

/// Columns that a filter must have room for.
pub fn required_capacity(configuration: &Configuration) -> usize {
    let layout = Layout::new(configuration);
    let entering = layout.input_count + layout.wheels() + noises(configuration);
    let forgotten = if configuration.forget_s > 0.0 {
        layout.unknown
    } else {
        0
    };
    layout.columns() + entering.max(forgotten).max(AXES - 1) + 1
}

/// Number of white noises that enter a step beside those of the inputs: of the momenta, and of the bias where it walks.
pub fn noises(configuration: &Configuration) -> usize {
    let momenta = if configuration.translates() { 2 } else { 1 };
    let bias = usize::from(configuration.noise.bias_walk > 0.0);
    (momenta + bias) * AXES
}

/// Product of the state in a row, and a column in its order.
pub fn dot(of_row: &[f64], column: &[f64]) -> f64 {
    of_row.iter().zip(column).map(|(a, b)| a * b).sum()
}
