# SPDX-License-Identifier: MIT
"""What breaks a contact that penalty and step allow."""
