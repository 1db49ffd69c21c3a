//! Thread pools that survive a fork.

use std::fmt;
use std::mem;
use std::process;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::thread;
use std::time::Duration;

use rayon::ThreadPoolBuilder;

use crate::OptionError;

/// Number of attempts, a millisecond apart, to get hold of the pool.
const ATTEMPTS: usize = 1000;

/// A pool of threads, which are started when first used.
///
/// The threads of a process do not exist in a process forked from it: work given to them there would never end. The pool starts new
/// ones in each process.
pub struct ThreadPool {
    num_threads: Option<usize>,
    started: Mutex<Option<Started>>,
}

/// The threads of one process.
struct Started {
    process: u32,
    pool: Arc<rayon::ThreadPool>,
}

impl ThreadPool {
    /// A pool of this number of threads; `None` for one per processor.
    pub const fn new(num_threads: Option<usize>) -> Self {
        Self { num_threads, started: Mutex::new(None) }
    }

    /// Runs `work` and the parallel loops in it on the threads of the pool.
    ///
    /// # Errors
    ///
    /// [`OptionError`] if the threads cannot be started.
    ///
    /// # Examples
    ///
    /// ```
    /// let pool = fedic::ThreadPool::new(Some(2));
    /// assert_eq!(pool.install(|| 1 + 1)?, 2);
    /// # Ok::<(), fedic::OptionError>(())
    /// ```
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, OptionError> {
        Ok(self.threads()?.install(work))
    }

    fn threads(&self) -> Result<Arc<rayon::ThreadPool>, OptionError> {
        // A fork can leave the lock closed for ever, if another thread held it.
        let Some(mut started) = self.lock() else { return self.start() };
        if let Some(Started { pool, .. }) = started.as_ref().filter(|started| started.process == process::id()) {
            return Ok(Arc::clone(pool));
        }
        let pool = self.start()?;
        let before = started.replace(Started { process: process::id(), pool: Arc::clone(&pool) });
        // The threads of another process cannot be stopped from here.
        mem::forget(before);
        Ok(pool)
    }

    fn lock(&self) -> Option<MutexGuard<'_, Option<Started>>> {
        (0..ATTEMPTS).find_map(|_| match self.started.try_lock() {
            Ok(started) => Some(started),
            Err(TryLockError::Poisoned(started)) => Some(started.into_inner()),
            Err(TryLockError::WouldBlock) => {
                thread::sleep(Duration::from_millis(1));
                None
            }
        })
    }

    fn start(&self) -> Result<Arc<rayon::ThreadPool>, OptionError> {
        let pool = ThreadPoolBuilder::new().num_threads(self.num_threads.unwrap_or(0)).build();
        pool.map(Arc::new).map_err(|_| {
            let value = self.num_threads.map_or("one per processor".to_owned(), |number| number.to_string());
            OptionError::invalid("num_threads", "a number of threads that this machine can start", &value)
        })
    }
}

impl fmt::Debug for ThreadPool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ThreadPool").field("num_threads", &self.num_threads).finish_non_exhaustive()
    }
}

/// Runs `work` on the threads of a pool, or on those of the caller.
///
/// # Errors
///
/// [`OptionError`] if the threads cannot be started.
pub(crate) fn in_pool<T: Send>(pool: Option<&ThreadPool>, work: impl FnOnce() -> T + Send) -> Result<T, OptionError> {
    match pool {
        Some(pool) => pool.install(work),
        None => Ok(work()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_runs_on_the_number_of_threads_asked_for() {
        for number in [1, 3] {
            let pool = ThreadPool::new(Some(number));
            assert_eq!(pool.install(rayon::current_num_threads), Ok(number));
        }
    }

    #[test]
    fn threads_are_started_once_in_a_process() {
        let pool = ThreadPool::new(Some(2));
        let first = pool.threads().map(|threads| Arc::as_ptr(&threads));
        assert_eq!(pool.threads().map(|threads| Arc::as_ptr(&threads)), first);
    }

    #[test]
    fn threads_of_another_process_are_replaced() {
        let pool = ThreadPool::new(Some(2));
        let first = pool.threads();
        if let Some(Some(started)) = pool.lock().as_deref_mut() {
            started.process += 1;
        }
        let second = pool.threads();
        assert!(first.is_ok() && second.as_ref().map(Arc::as_ptr) != first.as_ref().map(Arc::as_ptr));
        assert_eq!(pool.install(rayon::current_num_threads), Ok(2));
    }

    #[test]
    fn a_lock_that_stays_closed_does_not_stop_the_work() {
        let pool = ThreadPool::new(Some(1));
        let held = pool.lock();
        assert_eq!(pool.install(|| 7), Ok(7));
        drop(held);
    }
}
