//! Codes of the functions.

use poinsot_onboard::{Invalid, Refusal, TableError};

/// What a function returns. The numbers stay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum Code {
    /// Done.
    Ok = 0,
    /// Sample or time: a number is NaN or infinite.
    NotFinite = 1,
    /// Sample: the quaternion has not length one.
    Quaternion = 2,
    /// Sample: one of the same time was taken.
    Duplicate = 3,
    /// Sample: it is older than those that are held back.
    Late = 4,
    /// Sample: its time is too far from the newest.
    ClockJump = 5,
    /// A pointer is null.
    Null = 16,
    /// The memory for the filter is too small or not aligned as a double.
    Memory = 17,
    /// The memory has no filter: `init` was not called or failed.
    NotInitialised = 18,
    /// Table: another number of bytes.
    TableLength = 32,
    /// Table: it does not begin as one does.
    TableMagic = 33,
    /// Table: a version that this library does not know.
    TableVersion = 34,
    /// Table: a byte changed.
    TableChecksum = 35,
    /// Table: the filter is built with too few columns.
    Capacity = 36,
    /// Table: a number is NaN or infinite.
    TableNotFinite = 37,
    /// Table: too many wheels, joints or samples held back, or a link that no joint before it moves.
    Count = 38,
    /// Table: a noise, a limit or a spin inertia is out of range.
    Noise = 39,
    /// Table: the axis of a wheel or joint, or a quaternion, has not length one.
    Axis = 40,
    /// Table: the prior of an unknown number is not positive.
    Prior = 41,
    /// Table: the nominal vehicle has no positive mass or inertia.
    Unphysical = 42,
    /// Table: mass or first moment is unknown, but no position is measured and no joint moves.
    NeedsPosition = 43,
    /// Table: a mode's frequency or damping is out of range, or its slope of inertia is not symmetric.
    Mode = 44,
}

impl From<Refusal> for Code {
    fn from(why: Refusal) -> Self {
        match why {
            Refusal::NotFinite => Self::NotFinite,
            Refusal::Quaternion => Self::Quaternion,
            Refusal::Duplicate => Self::Duplicate,
            Refusal::Late => Self::Late,
            Refusal::ClockJump => Self::ClockJump,
        }
    }
}

impl From<TableError> for Code {
    fn from(why: TableError) -> Self {
        match why {
            TableError::Length => Self::TableLength,
            TableError::Magic => Self::TableMagic,
            TableError::Version(_) => Self::TableVersion,
            TableError::Checksum => Self::TableChecksum,
            TableError::Invalid(why) => why.into(),
        }
    }
}

impl From<Invalid> for Code {
    fn from(why: Invalid) -> Self {
        match why {
            Invalid::Capacity(_) => Self::Capacity,
            Invalid::NotFinite => Self::TableNotFinite,
            Invalid::Count => Self::Count,
            Invalid::Noise => Self::Noise,
            Invalid::Axis => Self::Axis,
            Invalid::Prior => Self::Prior,
            Invalid::Unphysical => Self::Unphysical,
            Invalid::NeedsPosition => Self::NeedsPosition,
            Invalid::Mode => Self::Mode,
        }
    }
}
