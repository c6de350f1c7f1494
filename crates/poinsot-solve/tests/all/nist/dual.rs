//! Dual numbers: a value with its exact gradient over the parameters.
#![allow(clippy::suspicious_arithmetic_impl)] // product and quotient rules

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Largest number of parameters.
pub const MOST: usize = 9;

#[derive(Clone, Copy)]
pub struct Dual {
    pub value: f64,
    pub gradient: [f64; MOST],
}

impl Dual {
    pub fn parameters(b: &[f64]) -> Vec<Dual> {
        let unit = |k| std::array::from_fn(|i| f64::from(u8::from(i == k)));
        b.iter()
            .enumerate()
            .map(|(k, &value)| Dual {
                value,
                gradient: unit(k),
            })
            .collect()
    }

    /// A function of one variable by the chain rule.
    fn chain(self, value: f64, slope: f64) -> Dual {
        Dual {
            value,
            gradient: self.gradient.map(|g| slope * g),
        }
    }

    pub fn exp(self) -> Dual {
        let e = self.value.exp();
        self.chain(e, e)
    }

    pub fn sin(self) -> Dual {
        self.chain(self.value.sin(), self.value.cos())
    }

    pub fn cos(self) -> Dual {
        self.chain(self.value.cos(), -self.value.sin())
    }

    pub fn atan(self) -> Dual {
        let x = self.value;
        self.chain(x.atan(), 1.0 / (1.0 + x * x))
    }

    pub fn square(self) -> Dual {
        self * self
    }

    pub fn power(self, exponent: f64) -> Dual {
        let slope = exponent * self.value.powf(exponent - 1.0);
        self.chain(self.value.powf(exponent), slope)
    }

    /// `base^self` for a constant base.
    pub fn exponent_of(self, base: f64) -> Dual {
        let p = base.powf(self.value);
        self.chain(p, p * base.ln())
    }

    /// `self^exponent`, both variable.
    pub fn to_the(self, exponent: Dual) -> Dual {
        let p = self.value.powf(exponent.value);
        let by_base = exponent.value * self.value.powf(exponent.value - 1.0);
        let by_exponent = p * self.value.ln();
        Dual {
            value: p,
            gradient: std::array::from_fn(|i| {
                by_base * self.gradient[i] + by_exponent * exponent.gradient[i]
            }),
        }
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Dual {
        Dual {
            value,
            gradient: [0.0; MOST],
        }
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, o: Dual) -> Dual {
        Dual {
            value: self.value + o.value,
            gradient: std::array::from_fn(|i| self.gradient[i] + o.gradient[i]),
        }
    }
}

impl Mul for Dual {
    type Output = Dual;
    fn mul(self, o: Dual) -> Dual {
        Dual {
            value: self.value * o.value,
            gradient: std::array::from_fn(|i| {
                self.gradient[i] * o.value + self.value * o.gradient[i]
            }),
        }
    }
}

impl Div for Dual {
    type Output = Dual;
    fn div(self, o: Dual) -> Dual {
        let q = self.value / o.value;
        Dual {
            value: q,
            gradient: std::array::from_fn(|i| (self.gradient[i] - q * o.gradient[i]) / o.value),
        }
    }
}

impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        self.chain(-self.value, -1.0)
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, o: Dual) -> Dual {
        self + -o
    }
}

impl Add<f64> for Dual {
    type Output = Dual;
    fn add(self, o: f64) -> Dual {
        self.chain(self.value + o, 1.0)
    }
}

impl Sub<f64> for Dual {
    type Output = Dual;
    fn sub(self, o: f64) -> Dual {
        self + -o
    }
}

impl Mul<f64> for Dual {
    type Output = Dual;
    fn mul(self, o: f64) -> Dual {
        self.chain(self.value * o, o)
    }
}

impl Div<f64> for Dual {
    type Output = Dual;
    fn div(self, o: f64) -> Dual {
        self.chain(self.value / o, 1.0 / o)
    }
}

impl Add<Dual> for f64 {
    type Output = Dual;
    fn add(self, o: Dual) -> Dual {
        o + self
    }
}

impl Sub<Dual> for f64 {
    type Output = Dual;
    fn sub(self, o: Dual) -> Dual {
        -o + self
    }
}

impl Mul<Dual> for f64 {
    type Output = Dual;
    fn mul(self, o: Dual) -> Dual {
        o * self
    }
}

impl Div<Dual> for f64 {
    type Output = Dual;
    fn div(self, o: Dual) -> Dual {
        Dual::from(self) / o
    }
}
