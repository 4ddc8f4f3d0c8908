"""One thread for linear algebra, in the tests and the processes that they start: imported before NumPy.

Its threads do not help matrices of this size. While they wait for each other they take the processors from
the tests that run beside.
"""

import os

os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
