"""The motion simulator of the paper's section 5.1: a KUKA KR 500 that carries a cabin."""
