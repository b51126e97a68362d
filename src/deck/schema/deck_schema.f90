! SPDX-License-Identifier: MIT
!> Known keywords and their cards.
!>
!> A line of the table that starts with a letter has the name of a keyword and its options: t with
!> an optional title, o the first card is optional, r cards are rows and blank rows are skipped,
!> =KEYWORD the cards are those of another keyword. The indented lines after it are its cards, with
!> fields `NAME:kind[treatment][width][=default][range]`. Kinds: i integer, f real, a text, x not
!> used. Treatments: none honoured, s ignored, w ignored with a warning, r refused. A 0 in an
!> honoured field means its default, as in LS-DYNA; `~default` is the default of blank fields only.
!> Ranges: `>0`, `>=0`, `<1`, `<=1`, two of them as in `>=0<1`, or the allowed integers as in
!> `|1|2|4`; they are checked when a card is read, for defaults too. The default width is 10.
!> Warnings and refusals apply to fields that are neither 0 nor their default.
module deck_schema_m
  use deck_schema_others_m, only : table_others
  use deck_schema_tables_m, only : table_control, table_mesh, table_conditions, table_contact, &
    table_database
  implicit none
  private
  public :: table, keyword_cards, find_keyword, nearest_keyword, expectations, &
    refusal_reason, text_of_field, distance_limit, update_nearest, max_card, known_honoured, &
    known_ignored, known_refused, known_not

  !> All honoured keywords and their cards.
  character(131), parameter :: table(*) = [character(131) :: table_control, table_mesh, &
    table_conditions, table_contact, table_database]
  !> Expected values of fields, for errors; the range is appended in parentheses unless the text has
  !> some. For fields with treatment w: end of the warning. Fields, or beginnings of keywords and
  !> fields, separated by commas; the first match counts.
  character(188), parameter :: expectations(*) = [character(188) :: &
    'CONTROL_TERM.DTMIN a fraction of the first time step', &
    'ENDTIM an end time', &
    'DFLAG a policy (1 to 5)', &
    'NOSOL 0 or 1 (stop after the initialisation)', &
    'TERMINATION_NODE.STOP 1 (x), 2 (y) or 4 (contact)', &
    'TERMINATION_BODY.STOP 1 (x), 2 (y) or 4 (displacement)', &
    'TERMINATION_CONTACT.DOF 0 (both), 1 (x) or 2 (y)', &
    'TSSFAC a scale of the step', &
    'LCTM,DATABASE.LCUR,DATABASE.LCDT,LCSR a curve number', &
    'ISDO an element length rule (0 area over longest side, 1 area over longest diagonal)', &
    'ERODE 0 or 1 (1: elements erode when their time step falls below DTMIN times the first step ' &
    //'or their volume vanishes)', &
    'MS1ST 0 or 1 (1: mass scaling at the start only)', &
    'DATABASE_ERROR.NORM 1 (energy of the stress error)', &
    'NRCYCK,CYCL a number of cycles', &
    'DRTOL a convergence tolerance', &
    'DRFCTR a relaxation factor', &
    'IDRFLG 0 (relaxation where a curve asks for it), 1 (in any case) or -999 (in no case)', &
    'ISTUPD 0 (constant thickness) or 1 (the thickness of plane stress follows its strain)', &
    'CONTROL_BULK_VISCOSITY.TYPE a kind of bulk viscosity that this version has (1 standard)', &
    'QH,QM an hourglass coefficient (0 to 10; 0.05 to 0.15 are usual)', &
    'Q1,Q2 a coefficient of bulk viscosity (0 to 100; Q1 1.5 and Q2 0.06 are usual)', &
    'ECDT 0 (a warning where contact needs a smaller step), 1 (none) or 2 (a step stable with ' &
    //'it)', &
    'IMFLAG a method that this version has (0 explicit, 1 implicit; no switching)', &
    'IMASS 0 (static) or 1 (dynamic)', &
    'ALPHA ALPHA of the HHT method (-1/3 to 0); Bathe''s method is not supported', &
    'RHO a spectral radius', &
    'NSOLVR a solution method that this version has (1 linear, 12 Newton)', &
    'IAUTO 0 (constant step) or 1 (automatic)', &
    'ITEOPT a number of iterations', &
    'CONTROL_IMPLICIT_AUTO.DTMAX a longest step (0 or more; curves of it are not supported)', &
    'BINARY 0, 1 (text file), 2 (binout) or 3 (both)', &
    'DATABASE.NSID a node set number', &
    'DATABASE.SSID a shell set number', &
    'NGAUSS a number of Gauss points', &
    'PUNIT a unit of the penalty (0 force per length at each contact node, 1 stress, 2 factor ' &
    //'on the built-in estimate, 3 share of the largest stable one, 4 factor on K L/A of ' &
    //'implicit springs)', &
    'PENT a penalty (above 0; blank and 0 mean PEN)', &
    'TFAC a ratio of the tangential to the normal penalty', &
    'TARGET a target of the contact error estimate (above 0, below 1)', &
    'SMOOTH a largest turn between segments of a round surface, degrees (0 is 16, -1 none)', &
    'VDC a damping in per cent of critical', &
    'IPF 0 or 1 (the strict rule of type 5)', &
    'FREQ a number of cycles between two searches', &
    'NODE.NID,N1,N2,N3,N4 a node number', &
    'NODE.X,NODE.Y a coordinate', &
    'TC a boundary code (0 none, 1 x, 2 y, 3 z, 4 xy, 5 yz, 6 zx, 7 xyz)', &
    'ELEMENT_SHELL.EID an element number', &
    'ELEMENT_SHELL.PID,ELEMENT_BEAM.PID a part number', &
    'NPLANE a number of points (1, or 4 with NIP 4)', &
    'NTHICK a number of points over the thickness (2D solids have 1)', &
    'FTYPE a format that this version has (0 or 10, text)', &
    'SID a set number', &
    'RO a density', &
    'E a Young''s modulus', &
    'MAT_MOONEY-RIVLIN.PR,MAT_OGDEN.PR a Poisson''s ratio of this law (more than 0 and less than ' &
    //'0.5; 0.49 and more is usual)', &
    'PR a Poisson''s ratio', &
    'G,G0,GI a shear modulus', &
    'BULK a bulk modulus', &
    'MAT_VISCO.BETA a decay constant', &
    'MAT_PLASTIC.SIGY,MAT_JOHNSON.A,MAT_SIMPLIFIED.A a yield stress', &
    'MAT_PLASTIC.BETA between 0 (kinematic) and 1 (isotropic hardening)', &
    'MAT_PLASTIC.FS,MAT_ELASTIC.FS,FAIL a plastic strain at failure (0 or more; 0 means never)', &
    'PC a pressure cut-off in tension (0 or less; 0 means none)', &
    'LCSS a curve or table number', &
    'MAT_PIECEWISE.VP a rate form that this version has (0 scales the yield stress with the ' &
    //'total strain rate)', &
    'VP a rate form (0 counts the total strain rate, 1 that of the plastic strain)', &
    'EPSO a strain rate', &
    'SPALL 1 (least pressure), 2 (largest stress) or 3 (largest tension)', &
    'MAT_CRUSHABLE.LCID the number of a curve: yield stress against volumetric strain 1 - V', &
    'NUMFIP a number of integration points (1 to 4)', &
    'EOS_GRUNEISEN.C a bulk sound speed (above 0, at most 1e12)', &
    'V0 an initial relative volume of this version (0 or 1: bodies start at the density RO)', &
    'TM,RIGIDWALL.MASS a mass', &
    'IZZ a moment of inertia', &
    'CMO 0 (no constraints) or 1 (constraints in global axes)', &
    'NIP a number of points (0, 1, 2 or blank: one point; 4: two by two, full integration)', &
    'SIDR a phase (0 run, 1 dynamic relaxation, 2 both)', &
    'DOFX,DOFY 0 (free) or 1 (fixed)', &
    'BOUNDARY_PRESCRIBED_MOTION_RIGID.DOF a degree of freedom of a rigid body in the plane (1 x, ' &
    //'2 y, 7 rotation about z)', &
    'LOAD_RIGID_BODY.DOF a load on a rigid body that this version has (1 x, 2 y, 7 moment about ' &
    //'z)', &
    'CONSTRAINED.DOF a direction code (1 x, 2 y, 3 z, 4 xy, 5 yz, 6 zx, 7 xyz)', &
    'DOF a direction that this version has (1 x, 2 y)', &
    'VAD a kind of motion that this version has (0 velocity, 1 acceleration, 2 displacement)', &
    'DAMPING_PART.LCID a curve number (1 or more); the curve gives the damping over time', &
    'BOUNDARY.LCID,LOAD.LCID a curve number', &
    'RIGIDWALL.NSID a node set, nor 0 (all nodes)', &
    'STYP a kind of set (1 part set, 2 part, 3 node set)', &
    'OMEGA a number of this size (at most 1e30)', &
    'FLAG 0 or 1 (a second card with factors of the directions)', &
    'COEF a fraction of critical damping (at most 1; below 0 it is a time)', &
    'TIE 0 (contact), 1 (tied) or 2 (tiebreak)', &
    'DAMP : the rate effect of the foam (viscous damping) is not included']
  !> Aliases of keywords and their names in the table.
  character(42), parameter :: aliases(*) = [character(42) :: &
    'MAT_001 MAT_ELASTIC', &
    'MAT_003 MAT_PLASTIC_KINEMATIC', &
    'MAT_006 MAT_VISCOELASTIC', &
    'MAT_007 MAT_BLATZ-KO_RUBBER', &
    'MAT_009 MAT_NULL', &
    'MAT_010 MAT_ELASTIC_PLASTIC_HYDRO', &
    'MAT_015 MAT_JOHNSON_COOK', &
    'MAT_020 MAT_RIGID', &
    'MAT_024 MAT_PIECEWISE_LINEAR_PLASTICITY', &
    'MAT_027 MAT_MOONEY-RIVLIN_RUBBER', &
    'MAT_063 MAT_CRUSHABLE_FOAM', &
    'MAT_077_O MAT_OGDEN_RUBBER', &
    'MAT_098 MAT_SIMPLIFIED_JOHNSON_COOK', &
    'EOS_001 EOS_LINEAR_POLYNOMIAL', &
    'EOS_004 EOS_GRUNEISEN', &
    'SET_NODE SET_NODE_LIST', &
    'SET_NODE_GENERATE SET_NODE_LIST_GENERATE', &
    'SET_PART SET_PART_LIST', &
    'SET_PART_GENERATE SET_PART_LIST_GENERATE', &
    'SET_SHELL SET_SHELL_LIST', &
    'SET_SHELL_GENERATE SET_SHELL_LIST_GENERATE', &
    'DATABASE_D3PLOT DATABASE_BINARY_D3PLOT', &
    'INCLUDE_PATH_RELATIVE INCLUDE_PATH']
  !> Reasons for refused fields; the standard ending (`refusal_reason`) is appended to texts without
  !> a `;`.
  character(145), parameter :: refusals(*) = [character(145) :: &
    'FRIC_S is a shear factor of friction', &
    'WVEL asks for welding of nodes to the wall', &
    'IGAPCL asks to project tied nodes onto the master surface, which this version does not ' &
    //'have; leave it 0 (a tie keeps its gap)', &
    'SURFB asks for the forces between two surfaces, which this version does not have; leave it ' &
    //'0 (a transducer adds up all forces on SURFA)', &
    'HSID,BSID,TSID,DSID is a set of elements that this version does not have; leave it 0 (SSID ' &
    //'is the shell set)', &
    'CID,ICID,VID,ID is a local coordinate system', &
    'TF lets the constraint fail, which this version does not have; leave it blank', &
    'CIDL gives the points in another system', &
    'FCTMAS,FCTTIM,FCTLEN,FCTTEM asks for other units in the included file', &
    'SRC,SRP asks for a Cowper-Symonds strain rate effect, which MAT_024 has (C and P); leave it ' &
    //'0 here', &
    'TDEL,DTF,TEROD,CEROD,CHARL,NUMINT asks for deletion of elements', &
    'IDAM,LCREGD,LCFLD,EPSTHIN,ENGCRT,RADCRT,LCEPS12,LCEPS13,LCEPSMX,MXTMP asks for a criterion ' &
    //'of erosion that this version does not have; leave it 0', &
    'RATEOP,C2_P_XNP_D,K asks for another form of the law of Johnson and Cook', &
    'SGL,SW,ST asks for constants that fit a test, which this version does not have; leave it 0 ' &
    //'and give A and B', &
    'REF asks for stress from another reference shape', &
    'SOLN asks for a thermal (1) or coupled thermal (2) analysis, which is not available in ' &
    //'slideline; 0 is the mechanical one', &
    'MODEL asks for another law of foams', &
    'N5,N6,N7,N8 is a mid-side node; elements and edges have corner nodes only here', &
    'SIGYZ,SIGZX is a shear stress out of the plane', &
    'NTENSR,NTHINT,NTHHSV asks for tensors or thermal values of points', &
    'BOXID is a box of nodes', &
    'PHASE is a velocity of dynamic relaxation', &
    'IRELAL asks for automatic control of the relaxation, which this version does not have; ' &
    //'leave it 0 and give DRFCTR', &
    'COUPLE,M,ALIAS couples the body to another program or to a surface file, which this ' &
    //'version does not have; leave it blank']
  !> Maximum number of characters by which a canonical name is longer than an alias (MAT_024).
  integer, parameter :: longest_addition = 24
  !> Maximum number of cards of a keyword.
  integer, parameter :: max_card = 6
  !> Treatment of a keyword.
  integer, parameter :: known_not = 0, known_honoured = 1, known_ignored = 2, known_refused = 3

contains

  !> Cards and options of a keyword (canonical name).
  subroutine keyword_cards(name, row, n_card, options)
    character(*), intent(in) :: name
    integer, intent(out) :: row       !! of the table; the cards are in the next rows
    integer, intent(out) :: n_card
    character(*), intent(out) :: options
    integer :: at

    options = ''
    n_card = 0
    row = row_of(name)
    if (row == 0) return
    options = table(row)(len_trim(name) + 2:)
    at = index(table(row), '=')
    if (at > 0) row = row_of(trim(table(row)(at + 1:)))
    do while (row + n_card < size(table))
      if (table(row + n_card + 1)(1:1) /= ' ') return
      n_card = n_card + 1
    end do
  end subroutine keyword_cards

  !> Row of a keyword (canonical name) in the table; 0 where it is not honoured.
  function row_of(name) result(i)
    character(*), intent(in) :: name
    integer :: i
    integer :: n

    n = len_trim(name)
    if (n > 0 .and. n < len(table)) then
      do i = 1, size(table)
        if (table(i)(n + 1:n + 1) /= ' ') cycle
        if (table(i)(:n) == name(:n)) return
      end do
    end if
    i = 0
  end function row_of

  !> Canonical name of a keyword without _TITLE and _ID, its treatment, and the reason of a refusal.
  subroutine find_keyword(given, name, known, titled, reason)
    character(*), intent(in) :: given               !! upper case
    character(*), intent(out) :: name
    integer, intent(out) :: known                   !! one of the `known_` constants
    logical, intent(out) :: titled
    character(:), allocatable, intent(out) :: reason
    character(len(given)) :: base
    character(len(table_others)) :: pattern
    integer :: i

    reason = ''
    known = known_honoured
    name = canonical(given)
    titled = .false.
    if (row_of(name) > 0) return
    call strip_option(given, base)
    name = canonical(base)
    i = row_of(name)
    if (i > 0) titled = index(table(i)(len_trim(name) + 1:), 't') > 0
    if (titled) return
    name = given
    known = known_not
    call find_other(given, i, pattern)
    if (i == 0) return
    reason = trim(table_others(i)(index(table_others(i), ' ') + 1:))
    if (reason /= 'unknown') known = merge(known_ignored, known_refused, reason == 'ignored')
  end subroutine find_keyword

  !> The name without its _TITLE or _ID; blank when it has none.
  pure subroutine strip_option(given, base)
    character(*), intent(in) :: given
    character(*), intent(out) :: base
    integer :: at, i
    character(6), parameter :: options(2) = ['_TITLE', '_ID   ']

    base = ''
    do i = 1, 2
      at = index(given//'_', trim(options(i))//'_')
      if (at == 0) cycle
      base = given(:at - 1)//given(at + len_trim(options(i)):)
      return
    end do
  end subroutine strip_option

  !> The name of a keyword in the table.
  pure function canonical(given) result(name)
    character(*), intent(in) :: given
    character(len(given) + longest_addition) :: name
    integer :: i, at

    name = given
    do i = 1, size(aliases)
      at = index(aliases(i), ' ')
      if (aliases(i)(:at) == given) name = aliases(i)(at + 1:)
    end do
  end function canonical

  !> The honoured keyword that is most similar to a name, at most two letters different; blank where
  !> there is none, or where the name is another keyword of LS-DYNA.
  function nearest_keyword(given) result(nearest)
    character(*), intent(in) :: given   !! upper case
    character(40) :: nearest, longer
    integer, parameter :: near = 2, least_length = 6
    integer :: least, i, n
    character(len(given)) :: base
    character(len(table_others)) :: pattern

    nearest = ''
    longer = ''
    if (len_trim(given) < least_length) return
    call find_other(given, i, pattern)
    ! Of families, as in `MAT_*`, and where a misspelt name must not pass for another.
    if (i > 0) then
      if (index(table_others(i), ' unknown ') == 0 .and. index(pattern, '_') &
        /= index(pattern, '_* ')) return
    end if
    least = near + 1
    call strip_option(given, base)
    if (len_trim(base) == 0) base = given
    do i = 1, size(table)
      if (table(i)(1:1) == ' ') cycle
      n = index(table(i), ' ') - 1
      if (index(base, '_') > 0 .and. index(table(i)(:n), trim(base)) == 1 &
        .and. (len_trim(longer) == 0 .or. n < len_trim(longer))) longer = table(i)(:n)
      call update_nearest(table(i)(:n), trim(base), least, nearest)
    end do
    ! An incomplete name: the shortest keyword that begins with it.
    if (len_trim(nearest) == 0) nearest = longer
  end function nearest_keyword

  !> The first row of the other keywords that matches a name, and the matching pattern; 0 where
  !> there is none.
  pure subroutine find_other(name, row, pattern)
    character(*), intent(in) :: name
    integer, intent(out) :: row
    character(*), intent(out) :: pattern
    integer :: start, n

    do row = 1, size(table_others)
      start = 1
      do while (start <= index(table_others(row), ' '))
        n = scan(table_others(row)(start:), ', ') - 1
        pattern = table_others(row)(start:start + n - 1)
        if (pattern == name) return
        if (pattern(n:n) == '*' .and. index(name, pattern(:n - 1)) == 1) return
        start = start + n + 1
      end do
    end do
    row = 0
  end subroutine find_other

  !> Reason for a refused field.
  pure function refusal_reason(field) result(text)
    character(*), intent(in) :: field
    character(:), allocatable :: text

    text = text_of_field(refusals, '', field)
    if (len(text) == 0) then
      text = 'is not supported here; leave it at its default'
    else if (index(text, ';') == 0) then
      text = text//', which this version does not have; leave it 0'
    end if
  end function refusal_reason

  !> The text of the first row that matches a field, alone or with the beginning of its keyword;
  !> empty where there is none.
  pure function text_of_field(rows, keyword, field) result(text)
    character(*), intent(in) :: rows(:), keyword, field
    character(:), allocatable :: text
    integer :: i, start, n, dot

    do i = 1, size(rows)
      start = 1
      do while (start <= index(rows(i), ' '))
        n = scan(rows(i)(start:), ', ') - 1
        dot = start + index(rows(i)(start:start + n - 1), '.') - 1
        if (rows(i)(dot + 1:start + n - 1) == field .and. index(keyword, rows(i)(start:dot - 1)) &
          == 1) then
          text = trim(rows(i)(index(rows(i), ' ') + 1:))
          return
        end if
        start = start + n + 1
      end do
    end do
    text = ''
  end function text_of_field

  !> Edit distance from which on names are not similar: three, less for short names.
  pure function distance_limit(name) result(letters)
    character(*), intent(in) :: name
    integer :: letters

    letters = min(3, (len(name) + 2)/2)
  end function distance_limit

  !> Replace the most similar name so far where another one is closer to the given name.
  pure subroutine update_nearest(name, given, least, nearest)
    character(*), intent(in) :: name, given      !! without blanks behind
    integer, intent(inout) :: least              !! its edit distance
    character(*), intent(inout) :: nearest
    integer :: distance

    if (abs(len(name) - len(given)) >= least) return
    distance = edit_distance(name, given)
    if (distance >= min(least, distance_limit(name))) return
    least = distance
    nearest = name
  end subroutine update_nearest

  !> Edit distance of two names (optimal string alignment: insertions, deletions, substitutions,
  !> transpositions).
  pure function edit_distance(a, b) result(distance)
    character(*), intent(in) :: a, b    !! without blanks behind
    integer :: distance
    integer :: cost(0:len(a), 0:len(b)), i, k

    cost = 0
    cost(:, 0) = [(i, i=0, len(a))]
    cost(0, :) = [(k, k=0, len(b))]
    do k = 1, len(b)
      do i = 1, len(a)
        cost(i, k) = min(cost(i - 1, k) + 1, cost(i, k - 1) + 1, &
          cost(i - 1, k - 1) + merge(0, 1, a(i:i) == b(k:k)))
        if (i == 1 .or. k == 1) cycle
        if (a(i:i) == b(k - 1:k - 1) .and. a(i - 1:i - 1) == b(k:k)) &
          cost(i, k) = min(cost(i, k), cost(i - 2, k - 2) + 1)
      end do
    end do
    distance = cost(len(a), len(b))
  end function edit_distance

end module deck_schema_m
