//! What bare metal has in place of the standard library.

use core::alloc::{GlobalAlloc, Layout};
use core::panic::PanicInfo;

/// No heap: the kernels link the crate `alloc`, but nothing here calls it.
struct NoHeap;

// SAFETY: a null pointer says that there is no memory; none was given that could be freed.
unsafe impl GlobalAlloc for NoHeap {
    unsafe fn alloc(&self, _: Layout) -> *mut u8 {
        core::ptr::null_mut()
    }

    unsafe fn dealloc(&self, _: *mut u8, _: Layout) {}
}

#[global_allocator]
static NO_HEAP: NoHeap = NoHeap;

/// An error of the library itself: it stops here, and the watchdog ends it.
#[panic_handler]
fn stop(_: &PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
