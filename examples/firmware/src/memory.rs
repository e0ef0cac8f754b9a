//! Stack used, read from the paint that cortex-m-rt puts on it before `main`, and the sizes that the linker knows.

use core::ptr;

/// What cortex-m-rt paints the stack with.
const PAINT: u32 = 0xcccc_cccc;
/// Bytes below the caller that are left alone when the stack is painted anew: the painter's own.
const MARGIN: usize = 256;

unsafe extern "C" {
    static _stack_start: u32;
    static _stack_end: u32;
    static __stext: u32;
    static __etext: u32;
    static __srodata: u32;
    static __erodata: u32;
    static __sdata: u32;
    static __edata: u32;
    static __sbss: u32;
    static __ebss: u32;
}

/// Bytes of the program's parts.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    /// Code.
    pub text: usize,
    /// Constants.
    pub rodata: usize,
    /// Memory that begins with a copy from flash.
    pub data: usize,
    /// Memory that begins as zeros.
    pub bss: usize,
}

impl Sizes {
    /// Of this program.
    #[must_use]
    pub fn of_program() -> Self {
        Self {
            text: between(&raw const __stext, &raw const __etext),
            rodata: between(&raw const __srodata, &raw const __erodata),
            data: between(&raw const __sdata, &raw const __edata),
            bss: between(&raw const __sbss, &raw const __ebss),
        }
    }
}

fn between(from: *const u32, to: *const u32) -> usize {
    to.addr() - from.addr()
}

/// Most bytes of stack in use at once since the start, or since it was painted anew; `None` if all of it was.
#[must_use]
pub fn stack_high_water() -> Option<usize> {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let mut at = end;
    while at < start {
        // SAFETY: between the two symbols lies the stack, which is memory of this program.
        if unsafe { ptr::read_volatile(at) } != PAINT {
            return (at > end).then(|| between(at, start));
        }
        at = at.wrapping_add(1);
    }
    Some(0)
}

/// Paints what of the stack is not in use now.
#[inline(never)]
pub fn paint_stack() {
    let here = PAINT;
    let top = (&raw const here).addr() - MARGIN;
    let mut at = (&raw const _stack_end).cast_mut();
    while at.addr() < top {
        // SAFETY: below this function's frame the stack holds nothing that is still used.
        unsafe { ptr::write_volatile(at, PAINT) };
        at = at.wrapping_add(1);
    }
}
