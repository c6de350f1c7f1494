//! Signals: an interruption leaves no draft behind; a limit of file size or memory is exit code 3.

/// Exit code where the system refuses.
#[cfg(unix)]
const ENVIRONMENT: i32 = 3;

/// Installs what is done on signals.
#[cfg(unix)]
pub fn install() {
    use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM};
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    // Caught, so that the write fails with its own error.
    let _ = signal_hook::flag::register(libc::SIGXFSZ, Arc::new(AtomicBool::new(false)));
    // Rust aborts where the system gives no memory, after a line that says so: no fault of the program.
    let always = Arc::new(AtomicBool::new(true));
    let _ = signal_hook::flag::register_conditional_shutdown(SIGABRT, ENVIRONMENT, always);
    let ignored = ignored_signals();
    let caught: Vec<i32> = [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|signal| ignored & (1 << (signal - 1)) == 0)
        .collect();
    let (ready, is_ready) = std::sync::mpsc::channel::<()>();
    // Without the thread the signals do what they always do.
    let _ = std::thread::Builder::new().spawn(move || {
        let Ok(mut signals) = signal_hook::iterator::Signals::new(caught) else {
            return;
        };
        drop(ready);
        for signal in signals.forever() {
            // A search ends with what it has; the next interruption ends the program.
            if signal == SIGINT && poinsot_design::interrupt::request() {
                continue;
            }
            poinsot_files::remove_stages();
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    });
    // Nothing is drafted before an interruption is caught.
    let _ = is_ready.recv();
}

/// Nothing to install.
#[cfg(not(unix))]
pub fn install() {}

/// Signals that the parent asked to ignore (`nohup`, a job in the background), one bit each, as Linux says.
/// Elsewhere nobody can be asked without unsafe code: none.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = poinsot_files::read_text("/proc/self/status".as_ref(), 1 << 20);
    status
        .unwrap_or_default()
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .unwrap_or(0)
}
