// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

// Standard output that is closed, as by `palpate … >&-`, takes nothing: the answer is lost. Before
// `main` begins, Rust opens /dev/null there, which cannot be told from one that the caller chose to
// lose the answer in. So that is done here before, with a file that can only be read.

#include <fcntl.h>

__attribute__((constructor)) static void mark_closed_output(void) {
  if (fcntl(1, F_GETFD) != -1)
    return;
  // The lowest descriptor that is free is taken: that of standard output, if that of input is not.
  int null = open("/dev/null", O_RDONLY);
  if (null == 0)
    (void)open("/dev/null", O_RDONLY);
}
