//! The filter of [`poinsot_onboard`] behind a C interface, as a static library for the desktop and for bare metal.
//!
//! `include/poinsot_onboard.h` declares and documents what is here; the tests compare both. `examples/app.c` uses it. The functions do not
//! allocate. Null pointers, wrong sizes and memory without a filter give a [`Code`]. What no code can tell is the caller's part: pointers
//! must be those of objects of the declared type, and one filter must not be used by two threads at once.
//!
//! This is the one crate of the project with `unsafe`.
//!
//! # Files
//! - `code.rs`: codes of the functions. `data.rs`: structs of the header. `bare.rs`: what bare metal has in place of the standard library.
#![cfg_attr(not(feature = "std"), no_std)]
#![allow(non_snake_case)]

#[cfg(target_os = "none")]
mod bare;
mod code;
mod data;

pub use code::Code;
pub use data::{Answer, MEASURED_ATTITUDE, MEASURED_GYRO, MEASURED_POSITION, Sample};

use core::mem::{align_of, size_of};
use core::ptr::addr_of_mut;
use poinsot_onboard::{COLUMNS, Configuration, Filter, TABLE};

/// Version of this interface: the header has the same.
pub const VERSION: u32 = 4;
/// Samples of the first window.
pub const WINDOW: usize = 150;
/// Bytes of the header's `poinsot_onboard`, enough on every target.
pub const SIZE: usize = 370_000;
/// What a filter's memory begins with.
const MARK: u64 = u64::from_le_bytes(*b"PNFILTER");

/// A filter in the caller's memory.
#[repr(C)]
pub struct Onboard {
    mark: u64,
    filter: Filter<COLUMNS, WINDOW>,
}

const _: () = assert!(size_of::<Onboard>() <= SIZE && align_of::<Onboard>() == align_of::<f64>());

/// The filter in the caller's memory.
///
/// # Safety
/// `filter` is null, or points to memory of [`SIZE`] bytes that nothing else uses during `'a`.
unsafe fn filter_in<'a>(filter: *mut Onboard) -> Result<&'a mut Filter<COLUMNS, WINDOW>, Code> {
    if filter.is_null() {
        return Err(Code::Null);
    }
    if !filter.is_aligned() {
        return Err(Code::Memory);
    }
    // SAFETY: not null, aligned, and readable by the promise of the caller.
    if unsafe { (*filter).mark } != MARK {
        return Err(Code::NotInitialised);
    }
    // SAFETY: as before; the mark is written only after a filter.
    Ok(unsafe { &mut (*filter).filter })
}

/// [`VERSION`] of the library.
#[unsafe(no_mangle)]
pub extern "C" fn poinsot_onboard_version() -> u32 {
    VERSION
}

/// Bytes that a filter needs on this target, at most [`SIZE`].
#[unsafe(no_mangle)]
pub extern "C" fn poinsot_onboard_size() -> usize {
    size_of::<Onboard>()
}

/// Makes a filter of a table of `length` bytes in `size` bytes of memory. One that was there begins anew.
///
/// # Safety
/// `filter` is null or points to `size` bytes that can be written, `table` is null or points to `length` bytes that can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poinsot_onboard_init(
    filter: *mut Onboard,
    size: usize,
    table: *const u8,
    length: usize,
) -> Code {
    if filter.is_null() || table.is_null() {
        return Code::Null;
    }
    if size < size_of::<Onboard>() || !filter.is_aligned() {
        return Code::Memory;
    }
    // SAFETY: not null, aligned and large enough. Until all is done there is no filter.
    unsafe { addr_of_mut!((*filter).mark).write(0) };
    if length != TABLE {
        return Code::TableLength;
    }
    // SAFETY: not null, of `TABLE` bytes, and bytes have no alignment.
    let table = unsafe { &*table.cast::<[u8; TABLE]>() };
    let configuration = match Configuration::from_table(table) {
        Ok(configuration) => configuration,
        Err(why) => return why.into(),
    };
    // SAFETY: not null, aligned and large enough. A copy of what is all zero, so that no stack holds a filter.
    unsafe { addr_of_mut!((*filter).filter).copy_from_nonoverlapping(&Filter::IDLE, 1) };
    // SAFETY: as before, and there is a filter now.
    if let Err(why) = unsafe { (*filter).filter.restart(&configuration) } {
        return why.into();
    }
    // SAFETY: not null, aligned and large enough.
    unsafe { addr_of_mut!((*filter).mark).write(MARK) };
    Code::Ok
}

/// Takes a sample, see [`Filter::push`].
///
/// # Safety
/// `filter` is null or was given to [`poinsot_onboard_init`]; `sample` is null or points to a sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poinsot_onboard_push(filter: *mut Onboard, sample: *const Sample) -> Code {
    // SAFETY: by the promise of the caller.
    let filter = match unsafe { filter_in(filter) } {
        Ok(filter) => filter,
        Err(code) => return code,
    };
    if sample.is_null() {
        return Code::Null;
    }
    // SAFETY: not null, and a sample by the promise of the caller; read without regard to its alignment.
    let sample = unsafe { sample.read_unaligned() };
    match filter.push(&sample.into()) {
        Ok(()) => Code::Ok,
        Err(why) => why.into(),
    }
}

/// Takes the samples that are held back, see [`Filter::flush`].
///
/// # Safety
/// `filter` is null or was given to [`poinsot_onboard_init`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poinsot_onboard_flush(filter: *mut Onboard) -> Code {
    // SAFETY: by the promise of the caller.
    match unsafe { filter_in(filter) } {
        Ok(filter) => filter.flush(),
        Err(code) => return code,
    }
    Code::Ok
}

/// Writes what is known at a time, s, to `answer`, see [`Filter::answer`].
///
/// # Safety
/// `filter` is null or was given to [`poinsot_onboard_init`]; `answer` is null or points to memory for an answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poinsot_onboard_read(
    filter: *mut Onboard,
    time_s: f64,
    answer: *mut Answer,
) -> Code {
    // SAFETY: by the promise of the caller.
    let filter = match unsafe { filter_in(filter) } {
        Ok(filter) => filter,
        Err(code) => return code,
    };
    if answer.is_null() {
        return Code::Null;
    }
    if !time_s.is_finite() {
        return Code::NotFinite;
    }
    let found = Answer::new(&filter.answer(time_s), &filter.counts());
    // SAFETY: not null, and writable by the promise of the caller; written without regard to its alignment.
    unsafe { answer.write_unaligned(found) };
    Code::Ok
}
