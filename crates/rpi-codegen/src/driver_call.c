bool driver_call(int number, const rpi_word *arguments, int count, rpi_word *results, int expected) {
  int k;
  printf("c %d", number);
  for (k = 0; k < count; k += 1) {
    driver_write(driver_bits(arguments[k].real));
  }
  printf("\n");
  fflush(stdout);
  if (driver_read() == 0U) {
    return false;
  }
  for (k = 0; k < expected; k += 1) {
    results[k].real = driver_real(driver_read());
  }
  return true;
}

