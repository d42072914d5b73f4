/* Start of the board mps2-an386 (Cortex-M4 with a floating-point unit for single precision): vector table, clock, memory,
   and the C library. */
#include <stdint.h>

extern uint32_t board_data_load[];
extern uint32_t board_data_start[];
extern uint32_t board_data_end[];
extern uint32_t board_zero_start[];
extern uint32_t board_zero_end[];
extern uint32_t board_stack_top[];
extern void _start(void);

static void board_reset(void);
static void board_stop(void);

typedef void (*board_handler)(void);

__attribute__((section(".vectors"), used)) static const struct {
  uint32_t *stack;
  board_handler handlers[15];
} board_vectors = {
    board_stack_top,
    {board_reset, board_stop, board_stop, board_stop, board_stop, board_stop, board_stop, board_stop,
     board_stop, board_stop, board_stop, board_stop, board_stop, board_stop, board_stop},
};

__attribute__((noreturn)) static void board_stop(void) {
  /* Semihosting: SYS_EXIT with the reason "run-time error", which ends the emulator with status 1. */
  register uint32_t operation __asm__("r0") = 0x18U;
  register uint32_t reason __asm__("r1") = 0x20023U;
  __asm__ volatile("bkpt 0xab" : : "r"(operation), "r"(reason) : "memory");
  for (;;) {
  }
}

/* The floating-point unit is off after a reset, so this function must not use it. */
__attribute__((noreturn, target("general-regs-only"))) static void board_reset(void) {
  volatile uint32_t *const access_control = (volatile uint32_t *)0xE000ED88U;
  const uint32_t *from = board_data_load;
  uint32_t *to = board_data_start;
  volatile uint32_t *const timer = (volatile uint32_t *)0xE000E010U;
  *access_control |= 0xFU << 20;
  __asm__ volatile("dsb\n isb");
  while (to < board_data_end) {
    *to = *from;
    to += 1;
    from += 1;
  }
  for (to = board_zero_start; to < board_zero_end; to += 1) {
    *to = 0U;
  }
  /* The timer SysTick counts down from its largest value, with the processor clock and without interrupts. */
  timer[1] = 0xFFFFFFU;
  timer[2] = 0U;
  timer[0] = 5U;
  _start();
  board_stop();
}
