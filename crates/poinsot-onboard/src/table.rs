//! A configuration as bytes: written on the ground, read without parsing text.
//!
//! All numbers are little-endian. Version 4 has [`TABLE`] bytes:
//!
//! | offset | type | content |
//! |---|---|---|
//! | 0 | 8 bytes | `PNONBRD` and a zero |
//! | 8 | u32 | version, 4 |
//! | 12 | u32 | number of bytes, 8892 |
//! | 16 | u32 | number of wheels |
//! | 20 | u32 | unknown parameters: bit k for the k-th of `poinsot_spatial::PARAMETER_NAMES` |
//! | 24 | u32 | samples that are held back |
//! | 28 | u32 | number of joints |
//! | 32 | u32 | link of the unknown body |
//! | 36 | u32 | joints that slide: bit k for the k-th |
//! | 40 | 7 x u32 | links that carry the joints |
//! | 68 | u32 | number of modes |
//! | 72 | u32 | numbers known with a sigma: bits 3k to 3k + 2 for the k-th wheel, 24 to 26 for the attitude sensor, 27 for the curve of the wheels |
//! | 76 | u32 | zero |
//! | 80 | 10 x f64 | known parameters of the base |
//! | 160 | 38 x f64 | nominal parameters of the unknown body, nominal errors of the known numbers |
//! | 464 | 741 x f64 | square root of the prior information, the upper triangle column by column |
//! | 6392 | 8 x 5 x f64 | wheels: axis x, y, z, spin inertia, noise |
//! | 6712 | 6 x f64 | noise: gyro, attitude, position, bias, bias walk, torque walk |
//! | 6760 | 2 x f64 | longest gap, time to stale |
//! | 6776 | 7 x f64 | unknown body in its link: rotation x, y, z, w, position |
//! | 6832 | 7 x 22 x f64 | joints: rotation x, y, z, w, position, axis, known parameters, noise of position and rate |
//! | 8064 | 6 x 17 x f64 | modes: frequency, damping ratio, translation, rotation, slope of inertia column by column |
//! | 8880 | f64 | time to forget |
//! | 8888 | u32 | CRC-32 of all bytes before it (ISO 3309, as in zlib) |

use crate::check::Invalid;
use crate::configuration::{Configuration, JOINTS};
use crate::numbers::PARAMETERS;

/// Bytes of a table.
pub const TABLE: usize = 8892;
const MAGIC: [u8; 8] = *b"PNONBRD\0";
const VERSION: u32 = 4;
const CHECKED: usize = TABLE - 4;
/// Words before the numbers, and the place of the first parent among them.
const WORDS: usize = MODES + 3;
/// Places of the number of modes and of the known numbers among them.
const MODES: usize = FIRST_PARENT + JOINTS;
const KNOWN: usize = MODES + 1;
const FIRST_PARENT: usize = 8;

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

impl Configuration {
    /// The table.
    ///
    /// ```
    /// use poinsot_onboard::{Configuration, Noise, TableError};
    ///
    /// let noise = Noise { gyro: 1e-4, attitude: 1e-4, position: 0.0, bias: 1e-4, bias_walk: 0.0, torque_walk: 0.0 };
    /// let cube = [6.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    /// let mut table = Configuration::new(cube, noise).to_table();
    /// assert_eq!(Configuration::from_table(&table)?.nominal[..10], cube);
    /// table[40] ^= 1;
    /// assert_eq!(Configuration::from_table(&table), Err(TableError::Checksum));
    /// # Ok::<(), TableError>(())
    /// ```
    pub fn to_table(&self) -> [u8; TABLE] {
        let mut copy = *self;
        let words = self.words().into_iter().flat_map(u32::to_le_bytes);
        let numbers = copy.numbers().flat_map(|x| x.to_le_bytes());
        let mut out = [0; TABLE];
        for (place, byte) in out
            .iter_mut()
            .zip(MAGIC.into_iter().chain(words).chain(numbers))
        {
            *place = byte;
        }
        let sum = crc32(&out[..CHECKED]);
        out[CHECKED..].copy_from_slice(&sum.to_le_bytes());
        out
    }

    /// What stands before the numbers. All are small in a valid configuration; others are refused when they are read.
    fn words(&self) -> [u32; WORDS] {
        let mask = |bits: &mut dyn DoubleEndedIterator<Item = bool>| {
            bits.rfold(0, |mask, bit| (mask << 1) | u32::from(bit))
        };
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let mut out = [0; WORDS];
        out[..FIRST_PARENT].copy_from_slice(&[
            VERSION,
            count(TABLE),
            count(self.wheel_count),
            mask(&mut self.uncertain.into_iter().take(PARAMETERS)),
            count(self.reorder),
            count(self.joint_count),
            count(self.unknown_link),
            mask(&mut self.joints.iter().map(|joint| joint.slides)),
        ]);
        for (place, joint) in out[FIRST_PARENT..].iter_mut().zip(&self.joints) {
            *place = count(joint.parent);
        }
        out[MODES] = count(self.mode_count);
        out[KNOWN] = mask(&mut self.uncertain.into_iter().skip(PARAMETERS));
        out
    }

    /// The configuration of a table; its numbers are checked for a filter of any size.
    ///
    /// # Errors
    /// The bytes are no table, changed, or no valid configuration.
    pub fn from_table(bytes: &[u8]) -> Result<Self, TableError> {
        let bytes: &[u8; TABLE] = bytes.try_into().map_err(|_| TableError::Length)?;
        let (magic, rest) = bytes.split_at(MAGIC.len());
        if magic != MAGIC {
            return Err(TableError::Magic);
        }
        let (words, _) = rest.as_chunks();
        let [version, _, wheels, unknown, reorder, joints, link, sliding] =
            core::array::from_fn(|k| u32::from_le_bytes(words[k]));
        if version != VERSION {
            return Err(TableError::Version(version));
        }
        let (checked, sum) = bytes.split_at(CHECKED);
        if sum != crc32(checked).to_le_bytes() {
            return Err(TableError::Checksum);
        }
        let known = u32::from_le_bytes(words[KNOWN]);
        let mut out = Self {
            wheel_count: wheels as usize,
            uncertain: core::array::from_fn(|k| match k.checked_sub(PARAMETERS) {
                None => unknown >> k & 1 == 1,
                Some(k) => known >> k & 1 == 1,
            }),
            reorder: reorder as usize,
            joint_count: joints as usize,
            unknown_link: link as usize,
            mode_count: u32::from_le_bytes(words[MODES]) as usize,
            ..Self::NONE
        };
        for (k, joint) in out.joints.iter_mut().enumerate() {
            joint.parent = u32::from_le_bytes(words[FIRST_PARENT + k]) as usize;
            joint.slides = sliding >> k & 1 == 1;
        }
        let (numbers, _) = rest[4 * WORDS..].as_chunks();
        for (place, number) in out.numbers().zip(numbers) {
            *place = f64::from_le_bytes(*number);
        }
        match out.check(usize::MAX) {
            Ok(()) => Ok(out),
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
