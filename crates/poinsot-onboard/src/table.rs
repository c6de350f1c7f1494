//! A configuration as bytes: written on the ground, read without parsing text.
//!
//! All numbers are little-endian. Version 2 has [`TABLE`] bytes:
//!
//! | offset | type | content |
//! |---|---|---|
//! | 0 | 8 bytes | `PNONBRD` and a zero |
//! | 8 | u32 | version, 2 |
//! | 12 | u32 | number of bytes, 2708 |
//! | 16 | u32 | number of wheels |
//! | 20 | u32 | unknown parameters: bit k for the k-th of `poinsot_spatial::PARAMETER_NAMES` |
//! | 24 | u32 | samples that are held back |
//! | 28 | u32 | number of joints |
//! | 32 | 10 x f64 | known parameters |
//! | 112 | 10 x f64 | nominal parameters of the unknown body |
//! | 192 | 10 x 10 x f64 | square root of the prior information, row by row |
//! | 992 | 8 x 5 x f64 | wheels: axis x, y, z, spin inertia, noise |
//! | 1312 | 6 x f64 | noise: gyro, attitude, position, bias, bias walk, torque walk |
//! | 1360 | 2 x f64 | longest gap, time to stale |
//! | 1376 | u32 | link of the unknown body |
//! | 1380 | u32 | joints that slide: bit k for the k-th |
//! | 1384 | 7 x f64 | unknown body in its link: rotation x, y, z, w, position |
//! | 1440 | 7 x u32 | links that carry the joints |
//! | 1468 | u32 | zero |
//! | 1472 | 7 x 22 x f64 | joints: rotation x, y, z, w, position, axis, known parameters, noise of position and rate |
//! | 2704 | u32 | CRC-32 of all bytes before it (ISO 3309, as in zlib) |

use crate::check::Invalid;
use crate::configuration::{Configuration, JOINTS, Joint, Noise, PARAMETERS, Wheel};

/// Bytes of a table.
pub const TABLE: usize = 2708;
const MAGIC: [u8; 8] = *b"PNONBRD\0";
const VERSION: u32 = 2;
const CHECKED: usize = TABLE - 4;

/// Why a table is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableError {
    /// It has another number of bytes than [`TABLE`].
    Length,
    /// It does not begin as a table does.
    Magic,
    /// It is of a version that this code does not know.
    Version(u32),
    /// A byte is not the one that was written.
    Checksum,
    /// Its numbers are no configuration.
    Invalid(Invalid),
}

/// Writes one number after the other.
struct Writer {
    bytes: [u8; TABLE],
    at: usize,
}

impl Writer {
    fn put(&mut self, bytes: &[u8]) {
        if let Some(place) = self.bytes.get_mut(self.at..self.at + bytes.len()) {
            place.copy_from_slice(bytes);
        }
        self.at += bytes.len();
    }

    fn word(&mut self, word: u32) {
        self.put(&word.to_le_bytes());
    }

    fn numbers(&mut self, numbers: &[f64]) {
        for number in numbers {
            self.put(&number.to_le_bytes());
        }
    }
}

/// Reads one number after the other.
struct Reader<'a> {
    bytes: &'a [u8; TABLE],
    at: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let found = self
            .bytes
            .get(self.at..)
            .and_then(|rest| rest.first_chunk());
        self.at += N;
        found.copied().unwrap_or([0; N])
    }

    fn word(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn number(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    fn numbers<const N: usize>(&mut self) -> [f64; N] {
        core::array::from_fn(|_| self.number())
    }
}

impl Configuration {
    /// The table.
    ///
    /// ```
    /// use poinsot_onboard::{Configuration, Noise, TableError};
    ///
    /// let noise = Noise { gyro: 1e-4, attitude: 1e-4, position: 0.0, bias: 1e-4, bias_walk: 0.0, torque_walk: 0.0 };
    /// let cube = [6.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    /// let mut table = Configuration::new(cube, noise).to_table();
    /// assert_eq!(Configuration::from_table(&table)?.nominal, cube);
    /// table[40] ^= 1;
    /// assert_eq!(Configuration::from_table(&table), Err(TableError::Checksum));
    /// # Ok::<(), TableError>(())
    /// ```
    pub fn to_table(&self) -> [u8; TABLE] {
        let mut out = Writer {
            bytes: [0; TABLE],
            at: 0,
        };
        let unknown = self.unknown.iter().rev();
        let mask = unknown.fold(0, |mask, unknown| (mask << 1) | u32::from(*unknown));
        // Small numbers in a valid configuration; others are refused when they are read.
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        out.put(&MAGIC);
        let words = [VERSION, count(TABLE), count(self.wheel_count), mask];
        let counts = [count(self.reorder), count(self.joint_count)];
        for word in words.into_iter().chain(counts) {
            out.word(word);
        }
        out.numbers(&self.known);
        out.numbers(&self.nominal);
        out.numbers(self.prior.as_flattened());
        for wheel in &self.wheels {
            out.numbers(&wheel.axis_B);
            out.numbers(&[wheel.spin_inertia, wheel.noise]);
        }
        let noise = &self.noise;
        out.numbers(&[noise.gyro, noise.attitude, noise.position]);
        out.numbers(&[noise.bias, noise.bias_walk, noise.torque_walk]);
        out.numbers(&[self.longest_gap_s, self.stale_s]);
        let sliding = self.joints.iter().rev();
        let sliding = sliding.fold(0, |mask, joint| (mask << 1) | u32::from(joint.slides));
        out.word(count(self.unknown_link));
        out.word(sliding);
        out.numbers(&self.unknown_rotation);
        out.numbers(&self.unknown_position);
        let parents = self.joints.iter().map(|joint| count(joint.parent));
        parents.chain([0]).for_each(|word| out.word(word));
        for number in self.joints.iter().flat_map(Joint::numbers) {
            out.numbers(&[number]);
        }
        let sum = crc32(&out.bytes[..CHECKED]);
        out.word(sum);
        out.bytes
    }

    /// The configuration of a table; its numbers are checked for a filter of any size.
    ///
    /// # Errors
    /// The bytes are no table, changed, or no valid configuration.
    pub fn from_table(bytes: &[u8]) -> Result<Self, TableError> {
        let bytes: &[u8; TABLE] = bytes.try_into().map_err(|_| TableError::Length)?;
        let mut table = Reader { bytes, at: 0 };
        if table.take::<8>() != MAGIC {
            return Err(TableError::Magic);
        }
        let version = table.word();
        if version != VERSION {
            return Err(TableError::Version(version));
        }
        let mut last = Reader { bytes, at: CHECKED };
        if last.word() != crc32(&bytes[..CHECKED]) {
            return Err(TableError::Checksum);
        }
        let [_, wheel_count, mask, reorder, joint_count] = core::array::from_fn(|_| table.word());
        let mut configuration = Self {
            known: table.numbers(),
            nominal: table.numbers(),
            unknown: core::array::from_fn(|k| mask >> k & 1 == 1),
            prior: core::array::from_fn::<_, PARAMETERS, _>(|_| table.numbers()),
            wheels: core::array::from_fn(|_| Wheel {
                axis_B: table.numbers(),
                spin_inertia: table.number(),
                noise: table.number(),
            }),
            wheel_count: wheel_count as usize,
            noise: Noise {
                gyro: table.number(),
                attitude: table.number(),
                position: table.number(),
                bias: table.number(),
                bias_walk: table.number(),
                torque_walk: table.number(),
            },
            longest_gap_s: table.number(),
            stale_s: table.number(),
            reorder: reorder as usize,
            joint_count: joint_count as usize,
            ..Self::NONE
        };
        let [link, sliding] = core::array::from_fn(|_| table.word());
        configuration.unknown_link = link as usize;
        configuration.unknown_rotation = table.numbers();
        configuration.unknown_position = table.numbers();
        let parents: [u32; JOINTS + 1] = core::array::from_fn(|_| table.word());
        configuration.joints = core::array::from_fn(|k| Joint {
            parent: parents[k] as usize,
            slides: sliding >> k & 1 == 1,
            rotation: table.numbers(),
            position: table.numbers(),
            axis: table.numbers(),
            known: table.numbers(),
            position_noise: table.number(),
            rate_noise: table.number(),
        });
        match configuration.check(usize::MAX) {
            Ok(()) => Ok(configuration),
            Err(why) => Err(TableError::Invalid(why)),
        }
    }
}

/// CRC-32 of ISO 3309: polynomial 0x04C11DB7, reflected, inverted at both ends.
fn crc32(bytes: &[u8]) -> u32 {
    let mut sum = u32::MAX;
    for byte in bytes {
        sum ^= u32::from(*byte);
        for _ in 0..u8::BITS {
            let reduced = if sum & 1 == 1 { 0xEDB8_8320 } else { 0 };
            sum = (sum >> 1) ^ reduced;
        }
    }
    !sum
}

#[cfg(test)]
mod tests {
    #[test]
    fn exact_crc_is_that_of_its_check_value() {
        assert_eq!(super::crc32(b"123456789"), 0xCBF4_3926);
    }
}
