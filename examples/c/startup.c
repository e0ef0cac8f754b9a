/* What comes before main on the board: vectors, the floating-point unit, then newlib's startup, which talks to QEMU by semihosting. */
#include <stdint.h>

extern uint32_t __stack;
void _start(void);

#define COPROCESSORS (*(volatile uint32_t *)0xE000ED88u)

void start(void)
{
    /* Full access to coprocessors 10 and 11. */
    COPROCESSORS |= 0xFu << 20;
    __asm volatile("dsb\n isb");
    _start();
}

static void stop(void)
{
    for (;;) {
    }
}

__attribute__((section(".vectors"), used)) static void *const vectors[16] = {
    &__stack, (void *)start, (void *)stop, (void *)stop, (void *)stop, (void *)stop, (void *)stop
};
